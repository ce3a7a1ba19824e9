#include <grapeshot/plugin/detail/shape_mesh.hpp>

#include <gmock/gmock.h>

#include <limits>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

detail::ShapeMesh read(const btCollisionShape& shape) {
    std::vector<detail::PartSource> sources;
    detail::sourcesOf(shape, sources);
    return detail::readMesh(sources);
}

Fault faultOfShape(const btCollisionShape& shape) {
    try {
        const detail::ShapeMesh mesh = read(shape);
        requireUsable(mesh.view());
    } catch (const Error& error) {
        return error.fault();
    }
    ADD_FAILURE() << "no error";
    return Fault::badFile;
}

TEST(ShapeMesh, AllKindsGiveTheSameScaledTriangles) {
    const scenes::Mesh source = scenes::torus(1, 0.3F, 8, 6);
    for (const Kind kind : allKinds) {
        const MeshShape shape(source, kind, 0.01_s, {2, 3, 0.5_s});
        const detail::ShapeMesh mesh = read(*shape);
        EXPECT_EQ(mesh.triangles, source.triangles);
        ASSERT_EQ(mesh.vertices.size(), source.vertices.size());
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            const Eigen::Vector3f expected = source.vertices[i].cwiseProduct(Eigen::Vector3f(2, 3, 0.5F));
            EXPECT_LT((mesh.vertices[i] - expected).norm(), 1e-6F);
        }
    }
}

TEST(ShapeMesh, ScaleOfTheInterfaceAndOfTheShapeAreBothApplied) {
    MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}), Kind::scaledBvh, 0.01_s, {2, 1, 1});
    shape.arrays->setScaling({1, 3, 1});
    const detail::ShapeMesh mesh = read(*shape);
    EXPECT_FLOAT_EQ(mesh.vertices[0].cwiseAbs().x(), 1.0F);
    EXPECT_FLOAT_EQ(mesh.vertices[0].cwiseAbs().y(), 1.5F);
}

TEST(ShapeMesh, GImpactIgnoresTheInterfacesScaleAsBulletDoes) {
    MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}), Kind::bvh);  // only for its arrays
    shape.arrays->setScaling({2, 2, 2});
    btGImpactMeshShape gimpact(shape.arrays.get());
    gimpact.setMargin(0);
    gimpact.updateBound();
    btVector3 lower;
    btVector3 upper;
    gimpact.getAabb(btTransform::getIdentity(), lower, upper);
    EXPECT_NEAR(upper.x(), 0.5, 1e-4);
    EXPECT_FLOAT_EQ(read(gimpact).vertices[0].cwiseAbs().x(), 0.5F);
    gimpact.setLocalScaling({3, 3, 3});
    EXPECT_FLOAT_EQ(read(gimpact).vertices[0].cwiseAbs().x(), 1.5F);
}

TEST(ShapeMesh, MirroringKeepsTheOutsideOutside) {
    for (const Kind kind : allKinds) {
        const MeshShape shape(scenes::sphere(1, 3), kind, 0.01_s, {-1, 2, 1});
        const detail::ShapeMesh mesh = read(*shape);
        const MeshReport report = inspect(mesh.view());
        EXPECT_TRUE(report.closed);
        EXPECT_GT(report.volume, 0);
    }
}

TEST(ShapeMesh, PartsKeepTheirNames) {
    const std::vector<scenes::Mesh> parts{scenes::box({1, 1, 1}), scenes::sphere(1, 2), scenes::box({1, 1, 1}, 2)};
    for (const Kind kind : {Kind::mesh, Kind::bvh}) {
        const MeshShape shape(parts, kind);
        const detail::ShapeMesh mesh = read(*shape);
        std::uint32_t triangle = 0;
        for (int part = 0; part < 3; ++part) {
            const auto count = static_cast<int>(parts[static_cast<std::size_t>(part)].triangles.size());
            for (int i = 0; i < count; ++i, ++triangle) {
                const detail::TriangleId id = detail::idOf(mesh.parts, triangle);
                EXPECT_EQ(id.part, part);
                EXPECT_EQ(id.index, i);
            }
        }
        EXPECT_EQ(triangle, mesh.triangles.size());
    }
}

/// Vertices in double, indices in 16 or 8 bits, odd strides.
template <class Index>
void expectReadable(PHY_ScalarType indexType) {
    const scenes::Mesh source = scenes::torus(1, 0.3F, 6, 4);
    constexpr std::size_t vertexStride = 3 * sizeof(double) + 5;
    constexpr std::size_t indexStride = 3 * sizeof(Index) + 3;
    std::vector<unsigned char> vertices(source.vertices.size() * vertexStride);
    std::vector<unsigned char> indices(source.triangles.size() * indexStride);
    for (std::size_t i = 0; i < source.vertices.size(); ++i) {
        const Eigen::Vector3d v = source.vertices[i].cast<double>();
        std::memcpy(&vertices[i * vertexStride], v.data(), 3 * sizeof(double));
    }
    for (std::size_t i = 0; i < source.triangles.size(); ++i) {
        Index corner[3];
        for (std::size_t c = 0; c < 3; ++c) {
            corner[c] = static_cast<Index>(source.triangles[i][c]);
        }
        std::memcpy(&indices[i * indexStride], corner, sizeof corner);
    }
    btTriangleIndexVertexArray arrays;
    btIndexedMesh indexed;
    indexed.m_numTriangles = static_cast<int>(source.triangles.size());
    indexed.m_triangleIndexBase = indices.data();
    indexed.m_triangleIndexStride = indexStride;
    indexed.m_numVertices = static_cast<int>(source.vertices.size());
    indexed.m_vertexBase = vertices.data();
    indexed.m_vertexStride = vertexStride;
    indexed.m_vertexType = PHY_DOUBLE;
    arrays.addIndexedMesh(indexed, indexType);
    btGImpactMeshShapePart shape(&arrays, 0);
    const detail::ShapeMesh mesh = read(shape);
    EXPECT_EQ(mesh.triangles, source.triangles);
    EXPECT_EQ(mesh.vertices, source.vertices);
}

TEST(ShapeMesh, ReadsAllTypesAndStrides) {
    expectReadable<std::uint32_t>(PHY_INTEGER);
    expectReadable<std::uint16_t>(PHY_SHORT);
    expectReadable<std::uint8_t>(PHY_UCHAR);
}

TEST(ShapeMesh, NamesWhatIsWrong) {
    const auto spoilt = [](auto spoil) {
        scenes::Mesh mesh = scenes::box({0.5F, 0.5F, 0.5F});
        spoil(mesh);
        return mesh;
    };
    // GImpact reads its triangles only when its box is asked for, so the shape itself is harmless here.
    const auto fault = [&](auto spoil) {
        scenes::Mesh mesh = spoilt(spoil);
        btTriangleIndexVertexArray arrays(static_cast<int>(mesh.triangles.size()),
                                          reinterpret_cast<int*>(mesh.triangles.data()), sizeof(Triangle), 0, nullptr,
                                          0);
        arrays.getIndexedMeshArray()[0].m_numVertices = static_cast<int>(mesh.vertices.size());
        arrays.getIndexedMeshArray()[0].m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices.data());
        arrays.getIndexedMeshArray()[0].m_vertexStride = sizeof(Eigen::Vector3f);
        arrays.getIndexedMeshArray()[0].m_vertexType = PHY_FLOAT;
        btGImpactMeshShapePart shape(&arrays, 0);
        return faultOfShape(shape);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(fault([&](scenes::Mesh& m) { m.vertices[3].y() = nan; }), Fault::notFinite);
    EXPECT_EQ(fault([&](scenes::Mesh& m) { m.vertices[3].y() = infinity; }), Fault::notFinite);
    EXPECT_EQ(fault([](scenes::Mesh& m) { m.triangles[2][1] = 8; }), Fault::indexOutOfRange);
    EXPECT_EQ(fault([](scenes::Mesh& m) { m.triangles[2][1] = 0x80000000U; }), Fault::indexOutOfRange);
    EXPECT_EQ(fault([](scenes::Mesh& m) { m.triangles.clear(); }), Fault::emptyMesh);
    EXPECT_EQ(fault([](scenes::Mesh& m) { m.vertices.clear(); }), Fault::emptyMesh);
    EXPECT_EQ(fault([](scenes::Mesh& m) {
                  for (Triangle& t : m.triangles) {
                      t[2] = t[1];
                  }
              }),
              Fault::noSurface);
}

TEST(ShapeMesh, AnIndexOfTheNextPartIsOutOfRange) {
    std::vector<scenes::Mesh> parts{scenes::box({1, 1, 1}), scenes::box({1, 1, 1})};
    MeshShape shape(parts, Kind::bvh);
    shape.further[0].triangles[0][0] = 9;  // exists only in the second
    EXPECT_EQ(faultOfShape(*shape), Fault::indexOutOfRange);
}

TEST(ShapeMesh, RefusesAScaleOfZeroOrNaN) {
    const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
    for (const Kind kind : {Kind::mesh, Kind::part, Kind::scaledBvh}) {
        MeshShape shape(scenes::box({0.5F, 0.5F, 0.5F}), kind);
        shape.shape->setLocalScaling({1, 0, 1});
        EXPECT_EQ(faultOfShape(*shape), Fault::badSetting);
        shape.shape->setLocalScaling({1, nan, 1});
        EXPECT_EQ(faultOfShape(*shape), Fault::badSetting);
    }
}

TEST(ShapeKind, MarginOfAGImpactMeshIsThatOfItsParts) {
    const MeshShape bvh(scenes::box({1, 1, 1}), Kind::bvh, 0.07_s);
    EXPECT_EQ(detail::marginOf(*bvh), 0.07_s);
    btGImpactMeshShape gimpact(bvh.arrays.get());
    EXPECT_EQ(detail::marginOf(gimpact), gimpact.getMeshPart(0)->getMargin());
    EXPECT_GT(detail::marginOf(gimpact), 0);
    gimpact.getMeshPart(0)->setMargin(0.03_s);
    EXPECT_EQ(detail::marginOf(gimpact), 0.03_s);
    gimpact.setMargin(-1);
    EXPECT_EQ(detail::marginOf(gimpact), 0);
    gimpact.setMargin(std::numeric_limits<btScalar>::quiet_NaN());
    EXPECT_EQ(detail::marginOf(gimpact), 0);
}

}  // namespace
}  // namespace grapeshot::test
