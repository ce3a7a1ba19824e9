// The traversal of ball trees down to leaves: nothing within the distance is missing, whatever the states and trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include <grapeshot/scf/close_leaves.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <adb/meshes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

std::vector<TrianglePair> trianglesOf(const BallTree& a, const BallTree& b, const std::vector<CloseLeaves>& leaves) {
    std::vector<TrianglePair> pairs;
    for (const CloseLeaves& close : leaves) {
        for (unsigned i = 0; i < 16; ++i) {
            for (unsigned j = 0; j < 16; ++j) {
                if ((close.row[i] >> j & 1U) != 0) {
                    pairs.push_back({a.leaves[close.leafA].triangle[i], b.leaves[close.leafB].triangle[j]});
                }
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

bool hasTwice(const std::vector<TrianglePair>& sorted) {
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

TEST(CloseLeaves, HoldAllPairsWithinTheDistanceAtRestAndDeformed) {
    Random random(5);
    CloseLeafSearch search;  // one for all trees
    std::vector<CloseLeaves> leaves;
    std::size_t total = 0;
    for (const NamedMesh& mesh : everyKind()) {
        SCOPED_TRACE(mesh.name);
        const BallTree tree = buildBallTree(mesh.mesh.view());
        std::vector<Eigen::Vector3f> stretched = tree.surface.rest;
        for (Eigen::Vector3f& vertex : stretched) {
            vertex.x() *= 1.2F;
        }
        const Tree boxes = build(mesh.mesh.view());
        for (int round = 0; round < 4; ++round) {
            const Pose pose = randomPose(boxes, boxes, random);
            const float reach = round % 2 == 0 ? 0 : 0.03F;
            SurfaceState moved = rigidState(pose);
            if (round >= 2) {
                moved.positions = stretched;
                moved.stretch = Stretch::given(1.2F);
            }
            // Both bodies have the same tree.
            const CloseLeafResult result = search.find(tree, rigidState(), tree, moved, reach, {}, {}, leaves);
            EXPECT_TRUE(result.complete);
            EXPECT_GT(result.work, 0U);
            const std::vector<TrianglePair> found = trianglesOf(tree, tree, leaves);
            EXPECT_FALSE(hasTwice(found));
            TrackSettings exact;
            exact.mode = TrackMode::exact;
            exact.maxDistance = reach;
            const TrackResult truth = Tracker(tree, tree).step(rigidState(), moved, exact);
            ASSERT_TRUE(truth.certain);
            for (const TrackedContact& contact : truth.contacts) {
                EXPECT_TRUE(std::binary_search(found.begin(), found.end(), contact.pair))
                    << contact.pair.triangleA << ", " << contact.pair.triangleB;
            }
            total += truth.contacts.size();
        }
    }
    EXPECT_GT(total, 1000U);
}

TEST(CloseLeaves, StayWithinTheBudgetAndSayWhenItEnds) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.3F, 5, 12).view());
    const SurfaceState moved = rigidState({Eigen::Matrix3f::Identity(), {1.2F, 0.3F, 0.1F}});
    CloseLeafSearch search;
    std::vector<CloseLeaves> all;
    std::vector<CloseLeaves> some;
    const CloseLeafResult whole = search.find(tree, rigidState(), tree, moved, 0.05F, {}, {}, all);
    ASSERT_GT(all.size(), 10U);
    for (std::uint64_t work = 0; work <= whole.work + 17; work += 5) {
        const CloseLeafResult result =
            search.find(tree, rigidState(), tree, moved, 0.05F, {.work = work}, {1, 2, work}, some);
        EXPECT_LE(result.work, work);
        EXPECT_LE(some.size(), all.size());
        EXPECT_EQ(result.complete && result.work == whole.work, result.complete);
        EXPECT_TRUE(result.complete || work < whole.work + 17);
    }
    EXPECT_EQ(some.size(), all.size());
}

TEST(CloseLeaves, AreTheSameOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.3F, 5, 8).view());
    const SurfaceState moved = rigidState({Eigen::Matrix3f::Identity(), {1.1F, 0.4F, 0}});
    std::vector<TrianglePair> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        std::vector<CloseLeaves> leaves;
        static_cast<void>(CloseLeafSearch().find(tree, rigidState(), tree, moved, 0.05F, {.work = 300}, {}, leaves));
        const std::vector<TrianglePair> found = trianglesOf(tree, tree, leaves);
        first = first.empty() ? found : first;
        EXPECT_EQ(found, first);
    }
}

TEST(CloseLeaves, OfWhatCannotBeUsedThereAreNone) {
    const BallTree tree = buildBallTree(scenes::box({1, 1, 1}, 2).view());
    const std::vector<Eigen::Vector3f> tooFew(3, Eigen::Vector3f::Zero());
    SurfaceState other = rigidState();
    other.positions = tooFew;
    SurfaceState turned = rigidState();
    turned.pose = Pose{2 * Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero()};
    std::vector<CloseLeaves> leaves;
    CloseLeafSearch search;
    for (const SurfaceState& bad : {other, turned}) {
        EXPECT_FALSE(search.find(tree, rigidState(), tree, bad, 0.1F, {}, {}, leaves).complete);
        EXPECT_TRUE(leaves.empty());
    }
    for (const float distance : {-1.0F, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_FALSE(search.find(tree, rigidState(), tree, rigidState(), distance, {}, {}, leaves).complete);
    }
    std::vector<Eigen::Vector3f> broken = tree.surface.rest;
    std::ranges::fill(broken, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    other.positions = broken;
    EXPECT_FALSE(search.find(tree, rigidState(), tree, other, 0.1F, {}, {}, leaves).complete);
}

}  // namespace
}  // namespace grapeshot::test
