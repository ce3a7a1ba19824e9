// Walking downhill from two vertices.
#include <gtest/gtest.h>

#include <cmath>

#include <grapeshot/scf/detail/descent.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

TEST(Descent, EndsWhereNoNeighbourIsNearer) {
    const BallTree tree = buildBallTree(scenes::sphere(1, 12).view());
    detail::PosedTree a(tree);
    detail::PosedTree b(tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {2.5F, 0, 0}};
    a.begin(tree.surface.rest, nullptr, 1);
    b.begin(tree.surface.rest, &pose, 1);
    const detail::PairSpace space{&a, &b, 0.01F, -1};
    Random random(2);
    const auto vertices = static_cast<std::uint32_t>(tree.surface.rest.size());
    int global = 0;
    for (int i = 0; i < 50; ++i) {
        std::uint64_t work = 0;
        const auto from = static_cast<std::uint32_t>(random.bits() % vertices);
        const auto to = static_cast<std::uint32_t>(random.bits() % vertices);
        const detail::VertexPair end = detail::descend(space, from, to, 1000, work);
        EXPECT_NEAR(end.square, (a.point(end.a) - b.point(end.b)).squaredNorm(), 1e-6F);
        EXPECT_LE(end.square, (a.point(from) - b.point(to)).squaredNorm());
        for (const std::uint32_t other : tree.surface.ring.of(end.a)) {
            EXPECT_GE((a.point(other) - b.point(end.b)).squaredNorm(), end.square);
        }
        for (const std::uint32_t other : tree.surface.ring.of(end.b)) {
            EXPECT_GE((b.point(other) - a.point(end.a)).squaredNorm(), end.square);
        }
        EXPECT_GT(work, 1U);
        EXPECT_LT(work, 200U);
        global += std::sqrt(end.square) < 0.55F ? 1 : 0;
    }
    EXPECT_EQ(global, 50);  // convex bodies have but one minimum
    std::uint64_t work = 0;
    (void)detail::descend(space, 0, 1, 3, work);
    EXPECT_LE(work, 3U);
    work = 0;
    (void)detail::descend({&a, &b, 10, -1}, 0, 1, 100, work);
    EXPECT_EQ(work, 0U);  // in contact already
}

TEST(Descent, OfABodyWithItselfStaysOutOfTheNeighbourhood) {
    const Roll roll;
    const std::vector<Eigen::Vector3f> positions = roll.at(0);
    detail::PosedTree posed(roll.tree);
    posed.begin(positions, nullptr, 3);
    const detail::PairSpace space{&posed, &posed, 0.01F, 0.5F};
    const Surface& surface = roll.tree.surface;
    Random random(3);
    const auto vertices = static_cast<std::uint32_t>(surface.rest.size());
    for (int i = 0; i < 50; ++i) {
        const auto from = static_cast<std::uint32_t>(random.bits() % vertices);
        const auto to = static_cast<std::uint32_t>(random.bits() % vertices);
        if ((surface.rest[from] - surface.rest[to]).norm() <= 0.5F) {
            continue;
        }
        std::uint64_t work = 0;
        const detail::VertexPair end = detail::descend(space, from, to, 1000, work);
        EXPECT_GT((surface.rest[end.a] - surface.rest[end.b]).norm(), 0.5F);
    }
}

TEST(Descent, NearestCornersAreTheNearestOfNine) {
    const TwoBumpy scene(6);
    const TwoBumpy::Frame where = scene.at(18);
    detail::PosedTree a(scene.a);
    detail::PosedTree b(scene.b);
    a.begin(where.a, nullptr, 2);
    b.begin(where.b, nullptr, 2);
    for (std::uint32_t t = 0; t < 50; ++t) {
        const detail::VertexPair nearest = detail::nearestCorners({&a, &b, 0, -1}, {t, 2 * t});
        float least = 1e9F;
        for (const std::uint32_t v : scene.meshA.triangles[t]) {
            for (const std::uint32_t w : scene.meshB.triangles[2 * t]) {
                least = std::min(least, (where.a[v] - where.b[w]).squaredNorm());
            }
        }
        EXPECT_EQ(nearest.square, least);
    }
}

}  // namespace
}  // namespace grapeshot::test
