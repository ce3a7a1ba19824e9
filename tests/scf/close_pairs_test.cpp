// The exact traversal of ball trees, against every pair of triangles and against the traversal of fitted boxes.
#include <gtest/gtest.h>

#include <algorithm>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/detail/pair_search.hpp>
#include <grapeshot/scf/stretch.hpp>

#include <adb/meshes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

using Pairs = std::vector<TrianglePair>;

Pairs closePairs(detail::PairSpace space, bool eager = false) {
    detail::PairSearch search;
    Pairs pairs;
    const auto end = search.run(space, {0, 0}, eager, unlimited, [&](const detail::PairBatch& batch, int lane) {
        pairs.push_back(batch.pair(lane));
        return true;
    });
    EXPECT_EQ(end, detail::SearchEnd::exhausted);
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// Shaken by waves, as many times as wanted.
std::vector<Eigen::Vector3f> shaken(const std::vector<Eigen::Vector3f>& rest, Random& random) {
    std::vector<Eigen::Vector3f> moved = rest;
    const Eigen::Vector3f axis = 3 * random.direction();
    const Eigen::Vector3f side = 0.15F * random.direction();
    for (Eigen::Vector3f& vertex : moved) {
        vertex += std::sin(axis.dot(vertex)) * side;
    }
    return moved;
}

/// Equal but for pairs that a rounding may put on either side of the reach.
void expectSameBut(const Pairs& found, const Pairs& expected, MeshView a, MeshView b, const Pose& pose, double reach) {
    Pairs different;
    std::ranges::set_symmetric_difference(found, expected, std::back_inserter(different));
    for (const TrianglePair& pair : different) {
        const double d = triangleDistance(cornersOf(a, pair.triangleA), cornersOf(b, pair.triangleB, pose));
        EXPECT_NEAR(d, reach, 2e-6) << pair.triangleA << ", " << pair.triangleB;
    }
}

TEST(ClosePairs, AreThoseOfBruteForceAndOfFittedBoxes) {
    Random random(11);
    std::size_t total = 0;
    for (const NamedMesh& mesh : everyKind()) {
        SCOPED_TRACE(mesh.name);
        const BallTree tree = buildBallTree(mesh.mesh.view());
        Tree boxes = build(mesh.mesh.view());
        Tree otherBoxes = boxes;
        detail::PosedTree a(tree);
        detail::PosedTree b(tree);
        for (int round = 0; round < 3; ++round) {
            const std::vector<Eigen::Vector3f> movedA = shaken(tree.surface.rest, random);
            const std::vector<Eigen::Vector3f> movedB = shaken(tree.surface.rest, random);
            refit(boxes, movedA);
            refit(otherBoxes, movedB);
            const Pose pose = randomPose(boxes, otherBoxes, random);
            const float reach = round == 0 ? 0 : 0.02F;
            const Pairs ofBoxes = [&] {
                Pairs pairs;
                for (const TriangleContact& c : Query(boxes, otherBoxes).contacts(pose, {.maxDistance = reach}).pairs) {
                    pairs.push_back(c.pair);
                }
                std::sort(pairs.begin(), pairs.end());
                return pairs;
            }();
            a.begin(movedA, nullptr, measureStretch(tree.surface, movedA));
            b.begin(movedB, &pose, measureStretch(tree.surface, movedB));
            const Pairs found = closePairs({&a, &b, reach, -1});
            EXPECT_EQ(found, ofBoxes);
            EXPECT_EQ(closePairs({&a, &b, reach, -1}, true), found);
            a.begin(movedA, nullptr, 0);
            b.begin(movedB, &pose, 0);
            EXPECT_EQ(closePairs({&a, &b, reach, -1}), found);
            expectSameBut(found, bruteForcePairs(boxes.mesh(), otherBoxes.mesh(), pose, reach), boxes.mesh(),
                          otherBoxes.mesh(), pose, reach);
            total += found.size();
        }
    }
    EXPECT_GT(total, 1000U);
}

TEST(ClosePairs, OfABodyWithItselfLeaveOutTheNeighbourhood) {
    Random random(12);
    std::size_t total = 0;
    for (const NamedMesh& mesh : everyKind()) {
        SCOPED_TRACE(mesh.name);
        const BallTree tree = buildBallTree(mesh.mesh.view());
        std::vector<Eigen::Vector3f> moved = tree.surface.rest;
        for (Eigen::Vector3f& vertex : moved) {
            vertex[0] *= 0.15F;                     // flat, so that opposite sides come near
            vertex += 0.002F * random.direction();  // the oracle takes almost coplanar neighbours for overlapping
        }
        detail::PosedTree a(tree);
        a.begin(moved, nullptr, measureStretch(tree.surface, moved));
        for (const float exclusion : {0.0F, 0.3F}) {
            const float reach = 0.03F;
            const Pairs found = closePairs({&a, &a, reach, exclusion});
            Pairs expected;
            const auto middle = [&](std::uint32_t t) {
                Eigen::Vector3f sum = Eigen::Vector3f::Zero();
                for (const std::uint32_t v : tree.surface.triangles[t]) {
                    sum += tree.surface.rest[v];
                }
                return Eigen::Vector3f(sum / 3);
            };
            for (const TrianglePair& pair :
                 bruteForcePairs({moved, tree.surface.triangles}, {moved, tree.surface.triangles}, {}, reach)) {
                bool shares = false;
                for (const std::uint32_t v : tree.surface.triangles[pair.triangleA]) {
                    shares = shares || std::ranges::count(tree.surface.triangles[pair.triangleB], v) > 0;
                }
                if (pair.triangleA < pair.triangleB && !shares &&
                    (middle(pair.triangleA) - middle(pair.triangleB)).norm() > exclusion) {
                    expected.push_back(pair);
                }
            }
            const MeshView view{moved, tree.surface.triangles};
            expectSameBut(found, expected, view, view, {}, reach);
            total += found.size();
        }
    }
    EXPECT_GT(total, 1000U);
}

TEST(ClosePairs, AreTheSameOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.3F, 5, 8).view());
    detail::PosedTree a(tree);
    detail::PosedTree b(tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {1.1F, 0.4F, 0}};
    Pairs first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        a.begin(tree.surface.rest, nullptr, 1);
        b.begin(tree.surface.rest, &pose, 1);
        const Pairs found = closePairs({&a, &b, 0.05F, -1});
        first = first.empty() ? found : first;
        EXPECT_EQ(found, first);
    }
    EXPECT_GT(first.size(), 50U);
}

TEST(PairSearch, KeepsItsLimitAndStopsWhenTold) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.3F, 5, 8).view());
    detail::PosedTree a(tree);
    detail::PosedTree b(tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {1.1F, 0.4F, 0}};
    a.begin(tree.surface.rest, nullptr, 1);
    b.begin(tree.surface.rest, &pose, 1);
    const detail::PairSpace space{&a, &b, 0.05F, -1};
    detail::PairSearch search;
    int found = 0;
    const auto count = [&](const detail::PairBatch&, int) { return ++found > 0; };
    EXPECT_EQ(search.run(space, {0, 0}, false, 0, count), detail::SearchEnd::limited);
    EXPECT_EQ(search.work(), 0U);
    EXPECT_EQ(search.run(space, {0, 0}, false, 40, count), detail::SearchEnd::limited);
    EXPECT_LE(search.work(), 40U + 17U + 16U);
    search.resetWork();
    EXPECT_EQ(search.run(space, {0, 0}, true, unlimited, [](const detail::PairBatch&, int) { return false; }),
              detail::SearchEnd::stopped);
    const std::uint64_t untilFirst = search.work();
    search.resetWork();
    EXPECT_EQ(search.run(space, {0, 0}, true, unlimited, count), detail::SearchEnd::exhausted);
    EXPECT_LT(untilFirst, search.work() / 4);
}

}  // namespace
}  // namespace grapeshot::test
