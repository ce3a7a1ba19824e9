#include <grapeshot/core/mesh_report.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

using scenes::Mesh;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

Mesh cube(float half = 1, int cells = 1) {
    return scenes::box(Eigen::Vector3f::Constant(half), cells);
}

Mesh mirrored(Mesh mesh) {
    for (Triangle& triangle : mesh.triangles) {
        std::swap(triangle[1], triangle[2]);
    }
    return mesh;
}

/// Every triangle with corners of its own.
Mesh split(const Mesh& mesh) {
    Mesh result;
    for (const Triangle& triangle : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(result.vertices.size());
        for (const std::uint32_t v : triangle) {
            result.vertices.push_back(mesh.vertices[v]);
        }
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

TEST(Inspect, ClosedCube) {
    const Mesh mesh = cube(1, 3);
    const MeshReport report = inspect(mesh.view());
    EXPECT_TRUE(report.closed);
    EXPECT_EQ(report.triangles, 108U);
    EXPECT_EQ(report.distinctVertices, 56U);
    EXPECT_EQ(report.pieces, 1U);
    EXPECT_EQ(report.boundaryEdges + report.nonManifoldEdges + report.misorientedEdges, 0U);
    EXPECT_EQ(report.degenerateTriangles, 0U);
    EXPECT_NEAR(report.volume, 8, 1e-5);
    EXPECT_NEAR(report.area, 24, 1e-5);
    EXPECT_EQ(report.lower, Eigen::Vector3f::Constant(-1));
    EXPECT_EQ(report.upper, Eigen::Vector3f::Constant(1));
    EXPECT_LT(report.relativePrecision, 1e-6);
}

TEST(Inspect, VolumeAndAreaOfASphere) {
    const Mesh mesh = scenes::sphere(2, 24);
    const MeshReport report = inspect(mesh.view());
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, 4.0 / 3.0 * std::numbers::pi * 8, 0.01 * 33.5);
    EXPECT_NEAR(report.area, 4 * std::numbers::pi * 4, 0.01 * 50);
}

TEST(Inspect, WeldingDoesNotNeedSharedVertices) {
    const Mesh mesh = split(cube());
    const MeshReport report = inspect(mesh.view());
    EXPECT_EQ(report.vertices, 36U);
    EXPECT_EQ(report.distinctVertices, 8U);
    EXPECT_TRUE(report.closed);
    EXPECT_EQ(report.pieces, 1U);
}

TEST(Inspect, ZeroAndMinusZeroAreOnePlace) {
    Mesh mesh = scenes::moved(cube(), {1, 1, 1});
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 2) {
        for (float& x : mesh.vertices[i]) {
            x = x == 0 ? -0.0F : x;
        }
    }
    mesh = split(mesh);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 2) {
        for (float& x : mesh.vertices[i]) {
            x = x == 0 ? -x : x;
        }
    }
    EXPECT_TRUE(inspect(mesh.view()).closed);
}

TEST(Inspect, InsideOutIsClosedWithNegativeVolume) {
    const Mesh mesh = mirrored(cube());
    const MeshReport report = inspect(mesh.view());
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, -8, 1e-5);
    EXPECT_THAT(describe(report), testing::HasSubstr("inside out"));
}

TEST(Inspect, OpenMesh) {
    Mesh mesh = cube();
    mesh.triangles.pop_back();
    const MeshReport report = inspect(mesh.view());
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.boundaryEdges, 3U);
    EXPECT_EQ(inspect(scenes::grid(1, 1, 4, 3).view()).boundaryEdges, 14U);
}

TEST(Inspect, OneTriangleTurnedRound) {
    Mesh mesh = cube();
    std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
    const MeshReport report = inspect(mesh.view());
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.misorientedEdges, 3U);
    EXPECT_EQ(report.boundaryEdges, 0U);
}

TEST(Inspect, NonManifold) {
    Mesh mesh = cube();
    const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(3.0F, 3.0F, 3.0F);
    mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], tip});
    const MeshReport report = inspect(mesh.view());
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.nonManifoldEdges, 1U);
    EXPECT_EQ(report.boundaryEdges, 2U);
}

TEST(Inspect, PiecesAndUnusedVertices) {
    Mesh mesh = scenes::merged(cube(), cube(), {5, 0, 0});
    mesh = scenes::merged(mesh, scenes::grid(1, 1, 2, 2), {0, 5, 0});
    mesh.vertices.emplace_back(9.0F, 9.0F, 9.0F);
    const MeshReport report = inspect(mesh.view());
    EXPECT_EQ(report.pieces, 3U);
    EXPECT_EQ(report.unusedVertices, 1U);
    EXPECT_LT(report.upper.maxCoeff(), 9.0F) << "an unused vertex stretches the box";
    EXPECT_EQ(inspect(scenes::chainShot(1, 0.2F, 16, 8).view()).pieces, 2U);
}

TEST(Inspect, BadCornersAreCountedAndLeftOut) {
    Mesh mesh = cube();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(nan, 0.0F, 0.0F);
    mesh.vertices.emplace_back(0.0F, -infinity, 0.0F);
    mesh.triangles.push_back({0, 1, first});
    mesh.triangles.push_back({0, first + 1, 2});
    mesh.triangles.push_back({0, 0xffffffffU, 1000000});
    const MeshReport report = inspect(mesh.view());
    EXPECT_EQ(report.notFiniteVertices, 2U);
    EXPECT_EQ(report.indicesOutOfRange, 2U);
    EXPECT_EQ(report.triangles, 15U);
    EXPECT_TRUE(report.closed) << "the cube itself is";
    EXPECT_NEAR(report.volume, 8, 1e-5);
}

TEST(Inspect, DegenerateTriangles) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1e-7F, 0}, {1, 1e-3F, 0}, {0, 0, 0}};
    mesh.triangles = {{0, 0, 1}, {0, 1, 2}, {0, 2, 3}, {0, 2, 4}, {0, 5, 1}};
    EXPECT_EQ(inspect(mesh.view()).degenerateTriangles, 4U);
}

TEST(Inspect, FarFromTheOriginPrecisionIsShort) {
    const Mesh near = cube(0.01F, 2);
    const Mesh far = scenes::moved(near, {100000, 0, 0});
    EXPECT_LT(inspect(near.view()).relativePrecision, 1e-5);
    const MeshReport report = inspect(far.view());
    EXPECT_GT(report.relativePrecision, 0.01);
    EXPECT_THAT(describe(report), testing::HasSubstr("single precision"));
}

TEST(Inspect, VolumeDoesNotDependOnThePlace) {
    const double volume = inspect(cube().view()).volume;
    const Mesh far = scenes::moved(cube(), {4096, -8192, 1024});
    EXPECT_NEAR(inspect(far.view()).volume, volume, 1e-9);
}

TEST(Inspect, NothingAtAll) {
    const MeshReport report = inspect({});
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.pieces, 0U);
    EXPECT_EQ(report.relativePrecision, 0);
    EXPECT_THAT(describe(report), testing::HasSubstr("0 triangles"));
}

struct Refusal {
    const char* name;
    Fault fault;
    const char* place;
    std::function<void(Mesh&)> spoil;
};

class RequireUsable : public testing::TestWithParam<Refusal> {};

TEST_P(RequireUsable, NamesTheFaultAndThePlace) {
    Mesh mesh = cube();
    GetParam().spoil(mesh);
    try {
        requireUsable(mesh.view());
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), GetParam().fault) << error.what();
        EXPECT_EQ(error.place(), GetParam().place);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Meshes, RequireUsable,
    testing::Values(Refusal{"noVertices", Fault::emptyMesh, "mesh", [](Mesh& m) { m.vertices.clear(); }},
                    Refusal{"noTriangles", Fault::emptyMesh, "mesh", [](Mesh& m) { m.triangles.clear(); }},
                    Refusal{"notANumber", Fault::notFinite, "vertex 3", [](Mesh& m) { m.vertices[3].y() = nan; }},
                    Refusal{"infinite", Fault::notFinite, "vertex 5", [](Mesh& m) { m.vertices[5].x() = infinity; }},
                    Refusal{"tooFar", Fault::tooLarge, "vertex 2", [](Mesh& m) { m.vertices[2].z() = -2e15F; }},
                    Refusal{"noSuchVertex", Fault::indexOutOfRange, "triangle 4",
                            [](Mesh& m) { m.triangles[4][1] = 1000; }},
                    Refusal{"flat", Fault::noSurface, "mesh",
                            [](Mesh& m) {
                                m.vertices.assign(8, {1, 2, 3});
                            }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(RequireUsableMeshes, OpenNonManifoldAndInsideOutPass) {
    Mesh open = cube();
    open.triangles.pop_back();
    EXPECT_NO_THROW(requireUsable(open.view()));
    EXPECT_NO_THROW(requireUsable(mirrored(cube()).view()));
    Mesh doubled = cube();
    doubled.triangles.push_back(doubled.triangles.front());
    EXPECT_NO_THROW(requireUsable(doubled.view()));
    EXPECT_NO_THROW(requireUsable(scenes::scaled(cube(), 1e15F).view()));
    EXPECT_NO_THROW(requireUsable(scenes::scaled(cube(), 1e-18F).view()));
}

}  // namespace
}  // namespace grapeshot
