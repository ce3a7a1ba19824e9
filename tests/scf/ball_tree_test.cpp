// The shape of ball trees, and that their balls hold whatever stays within the stretch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <grapeshot/scf/ball_tree_builder.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>
#include <grapeshot/scf/detail/sliced_selection.hpp>
#include <grapeshot/scf/stretch.hpp>

#include <adb/meshes.hpp>
#include <support/fault_of.hpp>
#include <support/poses.hpp>
#include <support/same_bytes.hpp>
#include <support/slices.hpp>

namespace grapeshot::test {
namespace {

std::vector<NamedMesh> meshes() {
    std::vector<NamedMesh> all = everyKind();
    all.push_back({"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}});
    all.push_back({"copies", copiesOfOne(50)});
    all.push_back({"needles", needles(60)});
    all.push_back({"two spheres", scenes::merged(scenes::sphere(1, 5), scenes::sphere(1, 5), {3, 0, 0})});
    return all;
}

TEST(BallTree, IsSound) {
    for (const NamedMesh& mesh : meshes()) {
        SCOPED_TRACE(mesh.name);
        EXPECT_THAT(findings(buildBallTree(mesh.mesh.view())), testing::IsEmpty());
    }
}

TEST(BallTree, InSlicesItIsTheSameAndEachSliceIsKept) {
    for (const NamedMesh& mesh : meshes()) {
        SCOPED_TRACE(mesh.name);
        const BallTree whole = buildBallTree(mesh.mesh.view());
        for (const std::uint64_t slice : {mostSlicedPiece, std::uint64_t{1000}}) {
            BallTree tree;
            const std::uint64_t work = inSlices(buildBallTreeInSlices(mesh.mesh.view(), tree), slice);
            EXPECT_LE(work, 60 * mesh.mesh.triangles.size() + 1000);
            EXPECT_GE(work, 5 * mesh.mesh.triangles.size());
            EXPECT_EQ(tree.surface.ring.all, whole.surface.ring.all);
            EXPECT_EQ(tree.surface.topology, whole.surface.topology);
            EXPECT_TRUE(sameBytes(tree.nodes, whole.nodes));
            EXPECT_TRUE(sameBytes(tree.restBalls, whole.restBalls));
            EXPECT_TRUE(sameBytes(tree.plainBalls, whole.plainBalls));
            EXPECT_TRUE(sameBytes(tree.leaves, whole.leaves));
            EXPECT_EQ(tree.leafOfTriangle, whole.leafOfTriangle);
            EXPECT_EQ(tree.leafVertices.all, whole.leafVertices.all);
            EXPECT_EQ(tree.extent, whole.extent);
        }
    }
}

TEST(SelectSliced, IsWhatNthElementIs) {
    Random random(5);
    for (int round = 0; round < 60; ++round) {
        std::vector<std::uint32_t> items(1 + random.bits() % 3000);
        for (std::size_t i = 0; i < items.size(); ++i) {
            items[i] = static_cast<std::uint32_t>(round % 3 == 0   ? i
                                                  : round % 3 == 1 ? items.size() - i
                                                                   : 7919 * i % 3001);
        }
        const std::size_t middle = random.bits() % items.size();
        std::vector<std::uint32_t> sorted = items;
        std::ranges::sort(sorted);
        inSlices(detail::selectSliced(items, 0, middle, items.size(), std::less<>{}), 8);
        EXPECT_EQ(items[middle], sorted[middle]);
        EXPECT_TRUE(std::all_of(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle),
                                [&](std::uint32_t one) { return one < sorted[middle]; }));
        std::ranges::sort(items);
        EXPECT_EQ(items, sorted);
    }
}

TEST(BallTree, FindingsFindWhatIsBroken) {
    const BallTree sound = buildBallTree(scenes::sphere(1, 8).view());
    BallTree broken = sound;
    broken.nodes[0].radius[1] *= 0.7F;
    EXPECT_FALSE(findings(broken).empty());
    broken = sound;
    broken.restBalls[0].radius[0] *= 0.7F;
    EXPECT_FALSE(findings(broken).empty());
    broken = sound;
    broken.leaves[0].triangle[0] = broken.leaves[1].triangle[0];
    EXPECT_FALSE(findings(broken).empty());
    broken = sound;
    broken.nodes[0].child[0] = 0;
    EXPECT_FALSE(findings(broken).empty());
}

TEST(BallTree, LeavesAreFullAndTheDepthIsLogarithmic) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.2F, 7, 16).view());
    const std::size_t triangles = tree.surface.triangles.size();
    EXPECT_EQ(tree.leaves.size(), (triangles + 15) / 16);
    EXPECT_LE(tree.nodes.size(), tree.leaves.size());
}

TEST(BallTree, IsTheSameAgain) {
    const scenes::Mesh mesh = scenes::torusKnot(2, 3, 1, 0.4F, 0.15F, 60, 12);
    const BallTree first = buildBallTree(mesh.view());
    const BallTree second = buildBallTree(mesh.view());
    ASSERT_EQ(first.nodes.size(), second.nodes.size());
    for (std::size_t i = 0; i < first.nodes.size(); ++i) {
        for (std::size_t slot = 0; slot < 4; ++slot) {
            EXPECT_EQ(first.nodes[i].center[slot], second.nodes[i].center[slot]);
            EXPECT_EQ(first.nodes[i].radius[slot], second.nodes[i].radius[slot]);
            EXPECT_EQ(first.nodes[i].child[slot], second.nodes[i].child[slot]);
        }
    }
}

TEST(BallTree, RefusesWhatIsNoSurface) {
    EXPECT_EQ(faultOf([] { (void)buildBallTree({}); }), Fault::emptyMesh);
}

/// Every corner below a slot is in its ball.
void expectHolds(detail::PosedTree& posed, std::uint32_t node, std::vector<std::uint32_t>& below) {
    const BallTree& tree = posed.tree();
    const FourBalls balls = posed.balls(node);
    for (std::uint32_t slot = 0; slot < tree.nodes[node].count; ++slot) {
        std::vector<std::uint32_t> part;
        const BallRef child = tree.nodes[node].child[slot];
        if (isBallLeaf(child)) {
            const auto vertices = tree.leafVertices.of(ballIndex(child));
            part.assign(vertices.begin(), vertices.end());
        } else {
            expectHolds(posed, ballIndex(child), part);
        }
        const Eigen::Vector3f center(balls.center[0][slot], balls.center[1][slot], balls.center[2][slot]);
        for (const std::uint32_t v : part) {
            EXPECT_LE((posed.point(v) - center).norm(), balls.radius[slot]) << "node " << node << " vertex " << v;
        }
        below.insert(below.end(), part.begin(), part.end());
    }
}

TEST(PosedTree, HoldsEverythingWithinTheStretch) {
    Random random(17);
    for (const NamedMesh& mesh : meshes()) {
        SCOPED_TRACE(mesh.name);
        const BallTree tree = buildBallTree(mesh.mesh.view());
        std::vector<Eigen::Vector3f> moved = tree.surface.rest;
        const Eigen::Vector3f axis = random.direction();
        for (Eigen::Vector3f& vertex : moved) {
            vertex +=
                0.2F * std::sin(3 * axis.dot(vertex)) * random.direction().cwiseAbs() + 0.003F * random.direction();
        }
        const float stretch = measureStretch(tree.surface, moved);
        detail::PosedTree posed(tree);
        const Pose pose{random.rotation(), 5 * random.direction()};
        std::vector<std::uint32_t> all;
        for (const Pose* where : {static_cast<const Pose*>(nullptr), &pose}) {
            for (const float bound : {stretch, 0.0F}) {
                if (std::isfinite(bound)) {
                    posed.begin(moved, where, bound);
                    expectHolds(posed, 0, all);
                    EXPECT_TRUE(posed.isFinite());
                }
            }
        }
    }
}

TEST(PosedTree, FittedBallsAreTighter) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.2F, 7, 12).view());
    detail::PosedTree posed(tree);
    posed.begin(tree.surface.rest, nullptr, 1.5F);
    const float wide = posed.balls(0).radius[0];
    posed.begin(tree.surface.rest, nullptr, 0);
    EXPECT_LT(posed.balls(0).radius[0], wide);
    posed.begin(tree.surface.rest, nullptr, 1.5F);
    EXPECT_EQ(posed.balls(0).radius[0], wide);
}

}  // namespace
}  // namespace grapeshot::test
