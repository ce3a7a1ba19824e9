#include <grapeshot/core/topology.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

using scenes::Mesh;

/// Neighbours are mutual, share the edge's two ends in opposite direction, and rings are what the triangles say.
void expectConsistent(const Mesh& mesh, const Topology& topology) {
    ASSERT_EQ(topology.welded.size(), mesh.vertices.size());
    ASSERT_EQ(topology.across.size(), mesh.triangles.size());
    ASSERT_EQ(topology.ringBegin.size(), mesh.vertices.size() + 1);
    std::vector<std::set<std::uint32_t>> rings(mesh.vertices.size());
    const auto end = [&](std::uint32_t t, std::size_t corner) {
        return topology.welded[mesh.triangles[t][corner % 3]];
    };
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t e = 0; e < 3; ++e) {
            if (end(t, e) != end(t, e + 1)) {
                rings[end(t, e)].insert(end(t, e + 1));
                rings[end(t, e + 1)].insert(end(t, e));
            }
            const std::uint32_t other = topology.across[t][e];
            if (other == noNeighbour) {
                continue;
            }
            ASSERT_LT(other, mesh.triangles.size());
            EXPECT_NE(other, t);
            bool mutual = false;
            for (std::size_t f = 0; f < 3; ++f) {
                mutual = mutual || (topology.across[other][f] == t && end(other, f) == end(t, e + 1) &&
                                    end(other, f + 1) == end(t, e));
            }
            EXPECT_TRUE(mutual) << "triangles " << t << " and " << other;
        }
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        EXPECT_EQ(mesh.vertices[topology.welded[v]], mesh.vertices[v]);
        EXPECT_LE(topology.welded[v], v);
        const auto ring = topology.ringOf(v);
        EXPECT_TRUE(std::is_sorted(ring.begin(), ring.end()));
        EXPECT_EQ(std::set<std::uint32_t>(ring.begin(), ring.end()), rings[v]);
        EXPECT_EQ(ring.size(), rings[v].size());
    }
}

std::size_t missing(const Topology& topology) {
    std::size_t count = 0;
    for (const auto& triangle : topology.across) {
        count += static_cast<std::size_t>(std::count(triangle.begin(), triangle.end(), noNeighbour));
    }
    return count;
}

TEST(Topology, ClosedMeshesHaveAllNeighbours) {
    for (const Mesh& mesh : {scenes::box({1, 2, 3}, 4), scenes::sphere(1, 5), scenes::torus(1, 0.3F, 12, 8),
                             scenes::chainShot(1, 0.2F, 12, 6), scenes::cup(1, 0.1F, 1, 12, 3)}) {
        const Topology topology = buildTopology(mesh.view());
        expectConsistent(mesh, topology);
        EXPECT_TRUE(topology.closed);
        EXPECT_EQ(missing(topology), 0U);
    }
}

TEST(Topology, VerticesOfTheTorusHaveSixNeighbours) {
    const Mesh mesh = scenes::torus(1, 0.3F, 12, 8);
    const Topology topology = buildTopology(mesh.view());
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        EXPECT_EQ(topology.ringOf(v).size(), topology.welded[v] == v ? 6U : 0U);
    }
}

TEST(Topology, SplitVerticesAreWelded) {
    const Mesh shared = scenes::sphere(1, 3);
    Mesh split;
    for (const Triangle& triangle : shared.triangles) {
        const auto first = static_cast<std::uint32_t>(split.vertices.size());
        for (const std::uint32_t v : triangle) {
            split.vertices.push_back(shared.vertices[v]);
        }
        split.triangles.push_back({first, first + 1, first + 2});
    }
    const Topology topology = buildTopology(split.view());
    expectConsistent(split, topology);
    EXPECT_TRUE(topology.closed);
    EXPECT_EQ(topology.across, buildTopology(shared.view()).across);
}

TEST(Topology, BordersAndBadEdgesHaveNoNeighbour) {
    const Mesh sheet = scenes::grid(1, 1, 3, 5);
    const Topology open = buildTopology(sheet.view());
    expectConsistent(sheet, open);
    EXPECT_FALSE(open.closed);
    EXPECT_EQ(missing(open), 16U);

    Mesh turned = scenes::box({1, 1, 1});
    std::swap(turned.triangles[0][0], turned.triangles[0][1]);
    const Topology misoriented = buildTopology(turned.view());
    expectConsistent(turned, misoriented);
    EXPECT_FALSE(misoriented.closed);
    EXPECT_EQ(missing(misoriented), 6U);

    Mesh winged = scenes::box({1, 1, 1});
    winged.vertices.emplace_back(5.0F, 5.0F, 5.0F);
    winged.triangles.push_back(
        {winged.triangles[0][0], winged.triangles[0][1], static_cast<std::uint32_t>(winged.vertices.size() - 1)});
    const Topology nonManifold = buildTopology(winged.view());
    expectConsistent(winged, nonManifold);
    EXPECT_FALSE(nonManifold.closed);
    EXPECT_EQ(missing(nonManifold), 5U);  // two sides of the edge, three of the wing
}

}  // namespace
}  // namespace grapeshot
