// Neighbours of a mesh, against their definition; and meshes that are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include <grapeshot/scf/surface.hpp>

#include <adb/meshes.hpp>
#include <support/fault_of.hpp>

namespace grapeshot::test {
namespace {

void expectNeighbours(MeshView mesh) {
    const Surface surface = makeSurface(mesh);
    std::vector<std::set<std::uint32_t>> ring(mesh.vertices.size());
    std::vector<std::set<std::uint32_t>> fan(mesh.vertices.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const std::uint32_t v : mesh.triangles[t]) {
            fan[v].insert(t);
            for (const std::uint32_t w : mesh.triangles[t]) {
                if (v != w) {
                    ring[v].insert(w);
                }
            }
        }
    }
    std::size_t edges = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        EXPECT_TRUE(std::ranges::equal(surface.ring.of(v), ring[v])) << "ring of " << v;
        EXPECT_TRUE(std::ranges::equal(surface.fan.of(v), fan[v])) << "fan of " << v;
        edges += ring[v].size();
        for (const std::uint32_t w : surface.edges.of(v)) {
            EXPECT_GT(w, v);
            EXPECT_TRUE(ring[v].contains(w));
        }
    }
    EXPECT_EQ(surface.edges.all.size(), edges / 2);
    EXPECT_EQ(surface.edgeSquare.size(), edges / 2);
}

TEST(Surface, KnowsItsNeighbours) {
    for (const NamedMesh& mesh : everyKind()) {
        SCOPED_TRACE(mesh.name);
        expectNeighbours(mesh.mesh.view());
    }
}

TEST(Surface, TakesEdgesOfAnyNumberOfTrianglesAndRepeatedCorners) {
    const std::vector<Eigen::Vector3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {9, 9, 9}};
    // Four triangles on one edge, one of them twice, and two without area.
    const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 4}, {2, 2, 3}, {4, 4, 4}};
    expectNeighbours({vertices, triangles});
}

TEST(Surface, NamesWhatCannotBeOne) {
    const std::vector<Eigen::Vector3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<Eigen::Vector3f> broken = vertices;
    broken[1][2] = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Triangle> one{{0, 1, 2}};
    const std::vector<Triangle> wild{{0, 1, 3}};
    const std::vector<Triangle> flat{{0, 1, 1}};
    EXPECT_EQ(faultOf([&] { (void)makeSurface({{}, one}); }), Fault::emptyMesh);
    EXPECT_EQ(faultOf([&] { (void)makeSurface({vertices, {}}); }), Fault::emptyMesh);
    EXPECT_EQ(faultOf([&] { (void)makeSurface({vertices, wild}); }), Fault::indexOutOfRange);
    EXPECT_EQ(faultOf([&] { (void)makeSurface({broken, one}); }), Fault::notFinite);
    EXPECT_EQ(faultOf([&] { (void)makeSurface({vertices, flat}); }), Fault::noSurface);
    EXPECT_EQ(faultOf([&] { (void)makeSurface({vertices, one}); }), std::nullopt);
}

TEST(Surface, KeyIsOfTheTrianglesAlone) {
    scenes::Mesh mesh = scenes::sphere(1, 3);
    const ContentKey key = makeSurface(mesh.view()).topology;
    mesh = scenes::moved(mesh, {1, 2, 3});
    EXPECT_EQ(makeSurface(mesh.view()).topology, key);
    std::swap(mesh.triangles[0], mesh.triangles[1]);
    EXPECT_FALSE(makeSurface(mesh.view()).topology == key);
}

}  // namespace
}  // namespace grapeshot::test
