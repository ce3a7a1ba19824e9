#include <grapeshot/narrowphase/relative_motion.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <scenes/shapes.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3d;
using test::Random;

Pose turned(const Pose& before, float angle, float shift, Random& random) {
    return {(Eigen::AngleAxisf(angle, random.direction()).toRotationMatrix() * before.rotation).eval(),
            before.translation + shift * random.direction()};
}

TEST(MotionBound, HoldsForEveryPointAndIsTight) {
    Random random(5);
    double tightest = 1e9, loosest = 0;
    for (int trial = 0; trial < 500; ++trial) {
        const Pose before{random.rotation(), random.direction()};
        const float angle = static_cast<float>(std::pow(10, random.uniform(-4, 0.4)));
        const Pose now = turned(before, angle, static_cast<float>(random.uniform(0, 0.1)), random);
        const float radius = static_cast<float>(random.uniform(0.1, 3));
        const float bound = motionBound(before, now, radius);
        double farthest = 0;
        for (int sample = 0; sample < 400; ++sample) {
            const Vector3d point = static_cast<double>(radius) * random.direction().cast<double>().normalized();
            const Vector3d moved = (now.rotation.cast<double>() - before.rotation.cast<double>()) * point +
                                   (now.translation - before.translation).cast<double>();
            farthest = std::max(farthest, moved.norm());
        }
        EXPECT_GE(static_cast<double>(bound), farthest);
        tightest = std::min(tightest, static_cast<double>(bound) / farthest);
        loosest = std::max(loosest, static_cast<double>(bound) / farthest);
    }
    EXPECT_LT(tightest, 1.05);
    EXPECT_LT(loosest, 1.6);
    const Pose pose{random.rotation(), random.direction()};
    EXPECT_LT(motionBound(pose, pose, 1), 1e-5F);
}

/// Largest way of samples of B's surface that are within `reach` of A's box now; -1 if there are none.
double farthestNear(const Tree& a, const Tree& b, const Pose& before, const Pose& now, double reach) {
    double farthest = -1;
    for (const Eigen::Vector3f& vertex : b.vertices) {
        const Vector3d x = vertex.cast<double>();
        const Vector3d here = now.rotation.cast<double>() * x + now.translation.cast<double>();
        const Vector3d there = before.rotation.cast<double>() * x + before.translation.cast<double>();
        const bool near = (here.array() >= a.lower.cast<double>().array() - reach).all() &&
                          (here.array() <= a.upper.cast<double>().array() + reach).all();
        farthest = near ? std::max(farthest, (here - there).norm()) : farthest;
    }
    return farthest;
}

TEST(NearMotionBound, HoldsForEveryPointThatIsNear) {
    const Tree a = build(scenes::cup(0.5F, 0.1F, 0.8F, 16, 4).view());
    const Tree b = build(scenes::bumpySphere(0.6F, 0.2F, 5, 8).view());
    Random random(6);
    int none = 0;
    int some = 0;
    for (std::size_t trial = 0; trial < test::sampleSize(300, 3000); ++trial) {
        const Pose now{random.rotation(), static_cast<float>(random.uniform(0, 1.8)) * random.direction()};
        const auto angle = static_cast<float>(std::pow(10, random.uniform(-4, -0.5)));
        const Pose before = turned(now, angle, static_cast<float>(random.uniform(0, 0.05)), random);
        const double farthest = farthestNear(a, b, before, now, 0.05);
        const float bound = nearMotionBound(a, b, before, now, 0.05F);
        if (bound <= 0) {
            EXPECT_LT(farthest, 0) << "near, but not seen";
            ++none;
        } else {
            EXPECT_GE(static_cast<double>(bound), farthest);
            ++some;
        }
        // Whoever says that it has moved little must be right.
        if (movedAtMost(0.02F, a, b, before, now, 0.05F)) {
            const double other = farthestNear(b, a, inverse(before), inverse(now), 0.05);
            EXPECT_LE(std::min(farthest, other), 0.02);
        }
    }
    EXPECT_GT(none, 5);
    EXPECT_GT(some, 100);
}

TEST(NearMotionBound, ABallThatRollsHardlyMovesWhereItTouches) {
    const Tree floor = build(scenes::box({4, 0.5F, 4}, 2).view());
    const Tree ball = build(scenes::sphere(0.5F, 8).view());
    const Pose before{Eigen::Matrix3f::Identity(), {0, 1, 0}};
    const float angle = 0.02F;
    const Pose now{Eigen::AngleAxisf(-angle, Eigen::Vector3f::UnitZ()).toRotationMatrix(), {0.5F * angle, 1, 0}};
    EXPECT_GT(motionBound(before, now, ball.radius), 0.019F);
    EXPECT_LT(nearMotionBound(floor, ball, before, now, 0.02F), 0.012F);
    EXPECT_TRUE(movedAtMost(0.012F, floor, ball, before, now, 0.02F));
    EXPECT_FALSE(movedAtMost(0.0005F, floor, ball, before, now, 0.02F));
}

}  // namespace
}  // namespace grapeshot
