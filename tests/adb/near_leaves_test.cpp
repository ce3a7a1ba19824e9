// `NearLeafSearch` against `Query::leafPairs` and brute force.
#include <grapeshot/adb/near_leaves.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

using Eigen::Vector3f;

/// Boxes of either side that grow, each in its mesh's frame.
struct Boxes {
    Vector3f lower[2], upper[2];
    void extend(int side, const Tree& tree, std::uint32_t triangle) {
        for (const std::uint32_t corner : tree.triangles[triangle]) {
            lower[side] = lower[side].cwiseMin(tree.vertices[corner]);
            upper[side] = upper[side].cwiseMax(tree.vertices[corner]);
        }
    }
};

TEST(NearLeaves, AreThoseOfTheQueryAndNothingNearIsOutsideOfTheBoxes) {
    const Tree a = build(scenes::cup(0.5F, 0.1F, 0.8F, 16, 4).view());
    const Tree b = build(scenes::bumpySphere(0.6F, 0.2F, 5, 6).view());
    Random random(8);
    NearLeafSearch search;
    NearLeaves near;
    LeafPairs all;
    std::size_t found = 0;
    std::size_t bounded = 0;
    for (std::size_t i = 0; i < sampleSize(60, 600); ++i) {
        const Pose pose = randomPose(a, b, random);
        const float distance = i % 3 == 0 ? 0.0F : 0.03F;
        const float reach = distance + static_cast<float>(random.uniform(0, 0.05));
        ASSERT_TRUE(search.find(a, b, pose, distance, reach, near));
        Query(a, b).leafPairs(pose, {distance, Order::depthFirst}, {}, all);
        EXPECT_EQ(near.pairs, all.pairs);
        EXPECT_EQ(near.work, all.work);
        found += near.pairs.size();
        Boxes boxes{{near.lower[0], near.lower[1]}, {near.upper[0], near.upper[1]}};
        for (const LeafPair& pair : near.pairs) {
            for (std::size_t lane = 0; lane < 4; ++lane) {
                if (a.leaves[pair.leafA].triangle[lane] != noTriangle) {
                    boxes.extend(0, a, a.leaves[pair.leafA].triangle[lane]);
                }
                if (b.leaves[pair.leafB].triangle[lane] != noTriangle) {
                    boxes.extend(1, b, b.leaves[pair.leafB].triangle[lane]);
                }
            }
        }
        for (const TrianglePair& pair : bruteForcePairs(a.mesh(), b.mesh(), pose, double{reach})) {
            Boxes triangles{{Vector3f::Constant(9), Vector3f::Constant(9)},
                            {Vector3f::Constant(-9), Vector3f::Constant(-9)}};
            triangles.extend(0, a, pair.triangleA);
            triangles.extend(1, b, pair.triangleB);
            for (int side = 0; side < 2; ++side) {
                EXPECT_TRUE((triangles.lower[side].array() >= boxes.lower[side].array() - 1e-5F).all() &&
                            (triangles.upper[side].array() <= boxes.upper[side].array() + 1e-5F).all())
                    << "pose " << i << ", side " << side;
            }
        }
        const float part = (boxes.upper[0] - boxes.lower[0]).prod() / (a.upper - a.lower).prod();
        bounded += !near.pairs.empty() && part < 0.5F ? 1U : 0U;
    }
    EXPECT_GT(found, 500U);
    EXPECT_GT(bounded, 5U) << "the boxes tell something";
}

TEST(NearLeaves, FarAndUnusableGiveNothing) {
    const Tree a = build(scenes::cup(0.5F, 0.1F, 0.8F, 16, 4).view());
    NearLeafSearch search;
    NearLeaves near;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Pose pose{Eigen::Matrix3f::Identity(), {5, 0, 0}};
    EXPECT_TRUE(search.find(a, a, pose, 0.1F, 0.2F, near));
    EXPECT_TRUE(near.pairs.empty() && near.work == 0 && near.lower[0].x() > near.upper[0].x());
    pose.translation = {1, 0, 0};
    EXPECT_TRUE(search.find(a, a, pose, 0.1F, 0.2F, near));
    EXPECT_FALSE(near.pairs.empty());
    for (const auto& [distance, reach] :
         {std::pair(-1.0F, 1.0F), std::pair(0.2F, 0.1F), std::pair(nan, 1.0F), std::pair(0.1F, nan)}) {
        EXPECT_FALSE(search.find(a, a, pose, distance, reach, near));
        EXPECT_TRUE(near.pairs.empty());
    }
    pose.translation.y() = nan;
    EXPECT_FALSE(search.find(a, a, pose, 0.1F, 0.2F, near));
}

}  // namespace
}  // namespace grapeshot::test
