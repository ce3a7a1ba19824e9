// The shape of the trees.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include <grapeshot/adb/reference/tree.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::reference {
namespace {

TEST(Hierarchy, HoldsEachTriangleInOneLeaf) {
    const scenes::Mesh mesh = scenes::gear(1, 0.2F, 0.3F, 0.3F, 10);
    for (const int mostPerLeaf : {1, 4}) {
        const Hierarchy hierarchy = buildHierarchy(mesh.view(), mostPerLeaf);
        std::set<std::uint32_t> seen;
        int deepest = 0;
        for (const TreeNode& node : hierarchy.nodes) {
            ASSERT_LT(node.begin, node.end);
            deepest = std::max(deepest, node.depth);
            if (!node.isLeaf()) {
                const TreeNode& left = hierarchy.nodes[node.left];
                const TreeNode& right = hierarchy.nodes[node.left + 1];
                EXPECT_EQ(left.begin, node.begin);
                EXPECT_EQ(left.end, right.begin);
                EXPECT_EQ(right.end, node.end);
                EXPECT_EQ(left.depth, node.depth + 1);
                EXPECT_LE(left.coneHalfAngle, std::numbers::pi);
                continue;
            }
            EXPECT_LE(node.end - node.begin, static_cast<std::uint32_t>(mostPerLeaf));
            seen.insert(hierarchy.triangleIds.begin() + node.begin, hierarchy.triangleIds.begin() + node.end);
        }
        EXPECT_EQ(seen.size(), mesh.triangles.size());
        EXPECT_EQ(hierarchy.maxDepth, deepest);
        EXPECT_LE(deepest, 2 + std::log(mesh.triangles.size()) / std::log(4.0 / 3)) << "at least a quarter on a side";
    }
}

TEST(Hierarchy, StandsCopiesOfOneTriangle) {
    scenes::Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles.assign(100, {0, 1, 2});
    const Hierarchy hierarchy = buildHierarchy(mesh.view());
    EXPECT_EQ(hierarchy.nodes.size(), 199U);
    EXPECT_LE(hierarchy.maxDepth, 9);
}

TEST(Hierarchy, KnowsHowFarNormalsSpread) {
    const Hierarchy flat = buildHierarchy(scenes::grid(1, 1, 4, 4).view());
    EXPECT_NEAR(flat.nodes[0].coneHalfAngle, 0, 1e-6);
    const Hierarchy closed = buildHierarchy(scenes::sphere(1, 6).view());
    EXPECT_NEAR(closed.nodes[0].coneHalfAngle, std::numbers::pi, 1e-9);
    for (const TreeNode& node : closed.nodes) {
        if (node.isLeaf()) {
            EXPECT_NEAR(node.coneHalfAngle, 0, 1e-6);
        }
    }
}

}  // namespace
}  // namespace grapeshot::reference
