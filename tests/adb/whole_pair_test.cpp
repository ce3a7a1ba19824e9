// What is said of two bodies before the first step, and where nothing may be said: shells inside each other.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include <grapeshot/adb/detail/surface_moments.hpp>
#include <grapeshot/adb/detail/whole_pair.hpp>
#include <grapeshot/adb/query.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"
#include "pair_cases.hpp"

namespace grapeshot::test {
namespace {

detail::SurfaceMoments momentsOf(const Tree& tree) {
    std::vector<detail::SurfaceMoments> pieces;
    for (const Triangle& triangle : tree.triangles) {
        const auto corner = [&](int i) { return tree.vertices[triangle[i]].cast<double>().eval(); };
        pieces.push_back(detail::momentsOf(corner(0), corner(1), corner(2)));
    }
    detail::SurfaceMoments all = detail::sum(pieces.data(), static_cast<int>(pieces.size()));
    all.covariance += detail::thickening * all.covariance.trace() * Eigen::Matrix3d::Identity();
    return all;
}

double plainly(const Tree& a, const Tree& b, const Pose& pose) {
    const detail::SurfaceMoments ofA = momentsOf(a);
    const detail::SurfaceMoments ofB = momentsOf(b);
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const Eigen::Vector3d d = rotation * ofB.mean + pose.translation.cast<double>() - ofA.mean;
    return d.dot((ofA.covariance + rotation * ofB.covariance * rotation.transpose()).ldlt().solve(d));
}

void expectRight(const Tree& a, const Tree& b, Random& random) {
    for (int i = 0; i < 20; ++i) {
        const Pose pose = randomPose(a, b, random);
        detail::PairPose prepared;
        if (detail::prepare(pose, a.radius, b.radius, 0, prepared) != detail::PoseVerdict::usable) {
            continue;
        }
        const double truth = plainly(a, b, pose);
        EXPECT_NEAR(detail::squaredDistanceOfWholes(a.whole, b.whole, prepared), truth, 1e-4 + 1e-3 * truth);
    }
}

TEST(Wholes, DistanceIsThatOfTheSurfaces) {
    Random random(3);
    const Tree large = build(scenes::scaled(scenes::spikedBall(1, 0.5F, 12, 400), 50).view());
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        Tree tree = build(kind.mesh.view());
        expectRight(tree, tree, random);
        expectRight(tree, large, random);
        expectRight(large, tree, random);
        std::vector<Eigen::Vector3f> bent = tree.vertices;
        for (Eigen::Vector3f& vertex : bent) {
            vertex.y() += 0.4F * vertex.x() * vertex.x();
        }
        refit(tree, bent);
        expectRight(tree, tree, random);
    }
}

TEST(Wholes, HaveNoUnit) {
    // In powers of two, so that nothing is rounded differently.
    Random random(5);
    const scenes::Mesh mesh = scenes::normalised(scenes::bumpySphere(1, 0.3F, 5, 6));
    const Tree tree = build(mesh.view());
    for (const float scale : {0x1p-40F, 0x1p40F}) {
        const Tree scaled = build(scenes::scaled(mesh, scale).view());
        for (int i = 0; i < 20; ++i) {
            Pose pose = randomPose(tree, tree, random);
            detail::PairPose prepared;
            ASSERT_EQ(detail::prepare(pose, 10, 10, 0, prepared), detail::PoseVerdict::usable);
            const float first = detail::squaredDistanceOfWholes(tree.whole, tree.whole, prepared);
            pose.translation *= scale;
            ASSERT_EQ(detail::prepare(pose, 10 * scale, 10 * scale, 0, prepared), detail::PoseVerdict::usable);
            EXPECT_NEAR(detail::squaredDistanceOfWholes(scaled.whole, scaled.whole, prepared), first, 1e-4F * first);
        }
    }
}

TEST(Wholes, SayNothingWherePrecisionEnds) {
    const Tree point = build(scenes::scaled(copiesOfOne(3), 1e-20F).view());
    detail::PairPose prepared;
    const Pose pose{Eigen::Matrix3f::Identity(), {1e-24F, 0, 0}};
    Tree nothing = point;
    nothing.whole = WholeSurface();  // of a mesh without extent
    ASSERT_EQ(detail::prepare(pose, 1, 1, 0, prepared), detail::PoseVerdict::usable);
    EXPECT_TRUE(std::isnan(detail::squaredDistanceOfWholes(nothing.whole, nothing.whole, prepared)));
}

TEST(Wholes, AFarBodyIsRejectedInOneUnit) {
    const Tree tree = build(scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 12)).view());
    const auto extent = (tree.upper - tree.lower).eval();
    // Far for a ball of such a spread, yet within the balls about the origins of two off their origin.
    const scenes::Mesh off = scenes::moved({tree.vertices, tree.triangles}, {3, 0, 0});
    const Tree moved = build(off.view());
    const Pose pose{Eigen::Matrix3f::Identity(), {0, 1.6F * extent.y(), 0}};
    Query query(moved, moved);
    DecideSettings settings;
    settings.tryWitness = false;
    const Decision decision = query.decide(pose, settings);
    EXPECT_FALSE(decision.collides);
    EXPECT_EQ(decision.stop, StopReason::probability);
    EXPECT_EQ(decision.work, 1U);
    EXPECT_GE(decision.probability, 1 - settings.rejectAt);
    EXPECT_EQ(query.decide(pose, settings, {.work = 0}).probability, 0.5F);  // it is a part of the first unit
    const Decision resumed = query.resume({});
    EXPECT_EQ(resumed.stop, StopReason::probability);
    EXPECT_EQ(resumed.work, 1U);
    EXPECT_TRUE(query.resume({}).certain);
    // Only with a limit on that side.
    settings.rejectAt = 0;
    EXPECT_TRUE(query.decide(pose, settings).certain);
}

struct Shells {
    int clear = 0, wrong = 0;
};
Shells shellsOf(const scenes::Mesh& mesh, float gap, Random& random) {
    const Tree outer = build(mesh.view());
    const float depth = gap * static_cast<float>(sizeOf(outer));
    const Tree inner = build(scenes::inwardCopy(mesh, depth).view());
    Query exact(outer, inner);
    Query query(outer, inner);
    Shells shells;
    for (std::size_t i = 0; i < sampleSize(12, 60); ++i) {
        const Pose pose{Eigen::Matrix3f::Identity(),
                        static_cast<float>(random.uniform(0, 2)) * depth * random.direction()};
        const bool truth = exact.decide(pose, DecideSettings::exact()).collides;
        const Decision decision = query.decide(pose);
        shells.clear += truth ? 0 : 1;
        shells.wrong += decision.collides != truth ? 1 : 0;
        // Stopped before the end it must not be sure either.
        const Decision stopped = query.decide(pose, {}, {.work = 8});
        shells.wrong += stopped.collides != truth && stopped.probability > 0.9F ? 1 : 0;
    }
    return shells;
}

TEST(Wholes, NestedShellsAreNotEstimated) {
    // Without the zone in which nothing is estimated, every other clear one of these would be called a collision.
    const scenes::Mesh meshes[] = {scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 12)),
                                   scenes::normalised(scenes::torusKnot(3, 4, 1, 0.5F, 0.17F, 160, 12)),
                                   scenes::normalised(scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2)),
                                   scenes::normalised(scenes::cup(0.7F, 0.09F, 1.3F, 24, 8))};
    Random random(17);
    int clear = 0;
    for (const scenes::Mesh& mesh : meshes) {
        for (const float gap : {0.0025F, 0.01F, 0.05F}) {
            SCOPED_TRACE(gap);
            const Shells shells = shellsOf(mesh, gap, random);
            clear += shells.clear;
            // 5 % is more than some walls are thick: the copy may be past the wall then, and no shell any more.
            EXPECT_LE(shells.wrong, gap < 0.02F ? 0 : static_cast<int>(sampleSize(12, 60)) / 4);
        }
    }
    EXPECT_GT(clear, static_cast<int>(sampleSize(12, 60)) * 3);
}

}  // namespace
}  // namespace grapeshot::test
