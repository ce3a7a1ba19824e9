#include <grapeshot/narrowphase/mesh_model.hpp>

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3f;
using scenes::Mesh;

Mesh flipped(Mesh mesh) {
    for (Triangle& triangle : mesh.triangles) {
        std::swap(triangle[0], triangle[1]);
    }
    return mesh;
}

TEST(MeshModel, SolidIsClosedAndNotInsideOut) {
    const Mesh torus = scenes::torus(1, 0.3F, 16, 8);
    EXPECT_TRUE(makeModel(torus.view()).solid);
    EXPECT_FALSE(makeModel(flipped(torus).view()).solid);
    EXPECT_FALSE(makeModel(scenes::grid(1, 1, 4, 4).view()).solid);
    Mesh open = torus;
    open.triangles.pop_back();
    EXPECT_FALSE(makeModel(open.view()).solid);
    EXPECT_TRUE(makeModel(scenes::chainShot(0.5F, 0.1F, 16, 8).view()).solid);
}

TEST(MeshModel, NormalsOfASphereAreRadial) {
    const Mesh sphere = scenes::sphere(2, 8);
    const MeshModel model = makeModel(sphere.view());
    for (std::size_t v = 0; v < sphere.vertices.size(); ++v) {
        EXPECT_GT(model.vertexNormals[v].dot(sphere.vertices[v].normalized()), 0.999F);
        EXPECT_NEAR(model.vertexNormals[v].norm(), 1, 1e-5F);
    }
    for (std::size_t t = 0; t < sphere.triangles.size(); ++t) {
        const Vector3f middle = (sphere.vertices[sphere.triangles[t][0]] + sphere.vertices[sphere.triangles[t][1]] +
                                 sphere.vertices[sphere.triangles[t][2]]) /
                                3;
        EXPECT_GT(model.triangleNormals[t].dot(middle.normalized()), 0.999F);
    }
}

// A cube's corner sees three right angles, however its faces are cut into triangles.
TEST(MeshModel, CornerNormalsDoNotDependOnTheTriangulation) {
    for (const int cells : {1, 2, 3}) {
        const Mesh cube = scenes::box(Vector3f::Ones(), cells);
        const MeshModel model = makeModel(cube.view());
        int corners = 0;
        for (std::size_t v = 0; v < cube.vertices.size(); ++v) {
            if (cube.vertices[v].cwiseAbs().minCoeff() > 0.999F) {
                ++corners;
                EXPECT_LT((model.vertexNormals[v] - cube.vertices[v] / std::sqrt(3.0F)).norm(), 1e-5F);
            }
        }
        EXPECT_GE(corners, 8);
    }
}

// The law of pseudonormals: the sign of (x - closest) . normal is the side, whatever the closest feature.
TEST(MeshModel, PseudonormalsTellInsideFromOutside) {
    const Mesh mesh = scenes::bumpySphere(1, 0.5F, 4, 3);
    const MeshModel model = makeModel(mesh.view());
    test::Random random(7);
    int corners = 0;
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vector3f x(static_cast<float>(random.uniform(-1.3, 1.3)), static_cast<float>(random.uniform(-1.3, 1.3)),
                         static_cast<float>(random.uniform(-1.3, 1.3)));
        const auto closest = closestPoint(model.tree, x, 10);
        ASSERT_TRUE(closest);
        if (closest->feature > 2 || closest->distance < 1e-4F) {
            continue;
        }
        ++corners;
        const std::uint32_t vertex = model.tree.triangles[closest->triangle][closest->feature];
        const bool in = (x - closest->point).dot(model.vertexNormals[vertex]) < 0;
        EXPECT_EQ(in, contains(model.tree, x)) << x.transpose();
        inside += in ? 1 : 0;
    }
    EXPECT_GT(corners, 100);
    EXPECT_GT(inside, 5);
}

TEST(MeshModel, TraitsOfABox) {
    const Mesh cube = scenes::box(Vector3f::Ones(), 4);
    const MeshModel model = makeModel(cube.view());
    const auto sides = [](const Vector3f& v) { return (v.cwiseAbs().array() > 0.999F).count(); };
    int sharp = 0;
    for (std::size_t t = 0; t < cube.triangles.size(); ++t) {
        for (unsigned c = 0; c < 3; ++c) {
            const Vector3f& from = cube.vertices[cube.triangles[t][c]];
            const Vector3f& to = cube.vertices[cube.triangles[t][(c + 1) % 3]];
            const bool rim = sides((from + to) / 2) == 2;
            EXPECT_EQ((model.traits[t] & (sharpEdge << c)) != 0, rim);
            EXPECT_EQ(model.traits[t] & (concaveEdge << c), 0);
            EXPECT_EQ((model.traits[t] & (flatCorner << c)) != 0, sides(from) == 1);
            sharp += rim ? 1 : 0;
        }
    }
    EXPECT_EQ(sharp, 2 * 12 * 4);
}

TEST(MeshModel, TraitsOfValleysAndBorders) {
    // Two triangles over the edge from (0,0,0) to (0,0,1), rising or falling to both sides.
    for (const float rise : {0.5F, -0.5F, 0.01F, -0.01F, 0.0F}) {
        Mesh mesh;
        mesh.vertices = {{0, 0, 0}, {0, 0, 1}, {1, rise, 0}, {-1, rise, 0}};
        mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
        const MeshModel model = makeModel(mesh.view());
        ASSERT_GT(model.triangleNormals[0].y(), 0);
        EXPECT_EQ((model.traits[0] & concaveEdge) != 0, rise > 0) << rise;
        EXPECT_EQ((model.traits[1] & concaveEdge) != 0, rise > 0) << rise;
        EXPECT_EQ((model.traits[0] & sharpEdge) != 0, rise < -0.1F) << rise;
        EXPECT_NE(model.traits[0] & (sharpEdge << 1U), 0) << "borders are sharp";
        EXPECT_EQ(model.traits[0] & (flatCorner * 7), 0) << "corners of a border are no flat ones";
    }
}

// Normals of degenerate triangles are zero, and poison nobody else's.
TEST(MeshModel, DegenerateTrianglesHaveNoNormal) {
    Mesh mesh = scenes::box(Vector3f::Ones());
    const std::size_t triangles = mesh.triangles.size();
    mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], mesh.triangles[0][0]});
    const MeshModel model = makeModel(mesh.view());
    EXPECT_TRUE(model.triangleNormals[triangles].isZero());
    for (std::size_t t = 0; t < triangles; ++t) {
        EXPECT_NEAR(model.triangleNormals[t].norm(), 1, 1e-6F);
    }
    for (const Vector3f& normal : model.vertexNormals) {
        EXPECT_TRUE(normal.allFinite());
    }
}

TEST(MeshModel, RefitIsANewModelOnTheOldTopology) {
    const Mesh sphere = scenes::sphere(1, 6);
    MeshModel model = makeModel(sphere.view());
    Mesh stretched = sphere;
    for (Vector3f& vertex : stretched.vertices) {
        vertex = vertex.cwiseProduct(Vector3f(1, 3, 0.5F)) + Vector3f(1, 2, 3);
    }
    refit(model, stretched.vertices);
    const MeshModel fresh = makeModel(stretched.view());
    ASSERT_EQ(model.triangleNormals.size(), fresh.triangleNormals.size());
    for (std::size_t t = 0; t < fresh.triangleNormals.size(); ++t) {
        EXPECT_EQ(model.triangleNormals[t], fresh.triangleNormals[t]);
    }
    for (std::size_t v = 0; v < fresh.vertexNormals.size(); ++v) {
        EXPECT_EQ(model.vertexNormals[v], fresh.vertexNormals[v]);
    }
    EXPECT_EQ(model.traits, fresh.traits);
    EXPECT_EQ(model.solid, fresh.solid);
    EXPECT_NEAR(model.report.volume, fresh.report.volume, 1e-6 * fresh.report.volume);
    EXPECT_NEAR(model.report.area, fresh.report.area, 1e-6 * fresh.report.area);
    EXPECT_EQ(model.report.upper, fresh.report.upper);
    // Turned inside out it is no solid any more.
    for (Vector3f& vertex : stretched.vertices) {
        vertex.x() = -vertex.x();
    }
    refit(model, stretched.vertices);
    EXPECT_FALSE(model.solid);
}

TEST(MeshModel, AFailedRefitChangesNothing) {
    const Mesh sphere = scenes::sphere(1, 4);
    MeshModel model = makeModel(sphere.view());
    std::vector<Vector3f> vertices = sphere.vertices;
    vertices[2].z() = std::numeric_limits<float>::infinity();
    EXPECT_THROW(refit(model, vertices), Error);
    vertices.pop_back();
    EXPECT_THROW(refit(model, vertices), Error);
    const MeshModel fresh = makeModel(sphere.view());
    EXPECT_EQ(model.tree.vertices, fresh.tree.vertices);
    EXPECT_EQ(model.triangleNormals, fresh.triangleNormals);
    EXPECT_EQ(model.report.volume, fresh.report.volume);
}

TEST(MeshModel, BadMeshesAreNamed) {
    EXPECT_THROW((void)makeModel({}), Error);
    Mesh mesh = scenes::box(Vector3f::Ones());
    mesh.triangles[1][2] = 77;
    try {
        (void)makeModel(mesh.view());
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::indexOutOfRange);
    }
}

}  // namespace
}  // namespace grapeshot
