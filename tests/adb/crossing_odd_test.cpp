// The crossing query on meshes, poses and settings that nobody wishes for: a defined answer.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <grapeshot/adb/crossing.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "crossings.hpp"
#include "meshes.hpp"
#include "pair_cases.hpp"

namespace grapeshot::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// At any budget a sound answer, and in the end the truth.
void expectDefined(const Tree& a, const Tree& b, const Pose& pose) {
    const bool truth = Query(a, b).decide(pose, DecideSettings::exact()).collides;
    CrossingQuery query(a, b);
    Crossing crossing;
    for (const std::uint64_t work : {0, 1, 2, 5, 30}) {
        query.find(pose, {.leaveOut = 0}, {work}, crossing);
        ASSERT_TRUE(wellFormed(crossing)) << "after " << work;
        ASSERT_TRUE(crossing.certain || crossing.work == work);
    }
    query.resume({}, crossing);
    ASSERT_TRUE(crossing.certain);
    ASSERT_TRUE(wellFormed(crossing));
    EXPECT_EQ(!crossing.pieces.empty(), truth);
    EXPECT_TRUE(same(crossing, exactCrossing(a, b, pose)));
}

TEST(CrossingOdd, MeshesHaveADefinedCurve) {
    std::vector<scenes::Mesh> odd{copiesOfOne(1),
                                  copiesOfOne(100),
                                  needles(300),
                                  scenes::grid(1, 1, 15, 15),
                                  scenes::moved(scenes::sphere(1, 8), {1e6F, -1e6F, 1e6F}),
                                  soup(2, 0.5F, 3)};
    for (const float scale : {1e-6F, 1e6F}) {
        odd.push_back(scenes::scaled(scenes::normalised(scenes::bumpySphere(1, 0.2F, 5, 8)), scale));
        odd.push_back(scenes::scaled(needles(200), scale));
    }
    scenes::Mesh flat = scenes::sphere(1, 4);  // in one plane, half of it without area
    for (Eigen::Vector3f& vertex : flat.vertices) {
        vertex.y() = 0;
    }
    odd.push_back(flat);
    scenes::Mesh line = scenes::sphere(1, 4);
    for (Eigen::Vector3f& vertex : line.vertices) {
        vertex.y() *= 1e-4F;
        vertex.z() = 1e-4F * vertex.z();
    }
    odd.push_back(line);
    int colliding = 0;
    int poses = 0;
    for (std::size_t i = 0; i < odd.size(); ++i) {
        SCOPED_TRACE(i);
        const Tree tree = build(odd[i].view());
        Random random(8);
        expectDefined(tree, tree, Pose{});  // every triangle on itself
        for (std::size_t k = 0; k < sampleSize(15, 200); ++k) {
            SCOPED_TRACE(k);
            const Pose pose = randomPose(tree, tree, random);
            expectDefined(tree, tree, pose);
            colliding += exactCrossing(tree, tree, pose).pieces.empty() ? 0 : 1;
            ++poses;
        }
    }
    EXPECT_GT(colliding, poses / 4);
    EXPECT_LT(colliding, poses * 9 / 10);
}

TEST(CrossingOdd, UnlikeSizesMeet) {
    const Tree small = build(scenes::scaled(scenes::bumpySphere(1, 0.2F, 5, 5), 1e-4F).view());
    const Tree large = build(scenes::scaled(scenes::sphere(1, 8), 1e3F).view());
    for (const float distance : {990.0F, 993.0F, 996.0F, 999.99F, 1000.0F}) {
        const Pose pose{Eigen::Matrix3f::Identity(), {0, distance, 0}};
        expectDefined(large, small, pose);
        expectDefined(small, large, inverse(pose));
    }
}

TEST(CrossingOdd, TrianglesThatTouchOrLieInOnePlaneAreProvenWithoutLength) {
    scenes::Mesh one = copiesOfOne(1);
    const Tree tree = build(one.view());
    Pose pose;
    pose.translation = {0.25F, 0.25F, 0};  // in one plane
    Crossing crossing = exactCrossing(tree, tree, pose);
    ASSERT_EQ(crossing.pieces.size(), 1U);
    EXPECT_TRUE(wellFormed(crossing));
    EXPECT_EQ(crossing.pieces[0].length, 0);
    EXPECT_EQ(crossing.pieces[0].direction.norm(), 0) << "both look the same way";
    pose.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    pose.translation = {0, 0.25F, 0};  // stands on it
    crossing = exactCrossing(tree, tree, pose);
    ASSERT_EQ(crossing.pieces.size(), 1U);
    EXPECT_TRUE(wellFormed(crossing));
    EXPECT_NEAR(crossing.pieces[0].direction.norm(), std::sqrt(2.0F), 1e-5);
    // Across each other, 0.5 long, below and above.
    pose.translation = {0, 0.25F, -0.25F};
    crossing = exactCrossing(tree, tree, pose);
    ASSERT_EQ(crossing.pieces.size(), 1U);
    EXPECT_NEAR(crossing.pieces[0].length, 0.75, 1e-6);
    EXPECT_NEAR(crossing.pieces[0].slope, 1, 1e-5);
    EXPECT_LE((crossing.pieces[0].position - Eigen::Vector3f(0.375F, 0.25F, 0)).norm(), 1e-6F);
    EXPECT_LE((crossing.pieces[0].direction - Eigen::Vector3f(0, -1, -1)).norm(), 1e-6F);
}

TEST(CrossingOdd, ManyCopiesOfOneTriangleEndWithTheBudget) {
    const Tree tree = build(copiesOfOne(static_cast<int>(sampleSize(200'000, 1'000'000))).view());
    CrossingQuery query(tree, tree);
    Crossing crossing;
    Pose pose;
    pose.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    // Beyond the long edge, where every box touches every other and no triangle does; and through all of them.
    for (const Eigen::Vector3f& place : {Eigen::Vector3f(0.75F, 0.6F, 0.5F), Eigen::Vector3f(0.25F, 0, 0.5F)}) {
        pose.translation = place;
        query.find(pose, {}, {2000}, crossing);
        EXPECT_EQ(crossing.stop, StopReason::budget);
        EXPECT_EQ(crossing.work, 2000U);
        EXPECT_TRUE(wellFormed(crossing));
        query.resume({3000}, crossing);
        EXPECT_EQ(crossing.work, 5000U);
        EXPECT_TRUE(wellFormed(crossing));
    }
    EXPECT_GT(provenPairs(crossing).size(), 1000U);
}

TEST(CrossingOdd, NoGeometryHasNoCurve) {
    const Tree none;
    const Tree ball = build(scenes::sphere(1, 3).view());
    for (const auto& [a, b] : {std::pair{&none, &ball}, {&ball, &none}, {&none, &none}}) {
        for (const std::uint64_t work : {std::uint64_t{0}, std::uint64_t{5}, unlimited}) {
            const Crossing crossing = crossingAfter(*a, *b, Pose{}, work);
            EXPECT_TRUE(crossing.certain);
            EXPECT_TRUE(crossing.pieces.empty());
            EXPECT_EQ(crossing.work, 0U);
        }
    }
    // Too far apart to look: certain without work.
    const Crossing crossing = crossingAfter(ball, ball, {Eigen::Matrix3f::Identity(), {3, 0, 0}}, 0);
    EXPECT_TRUE(crossing.certain);
    EXPECT_TRUE(crossing.pieces.empty());
}

TEST(CrossingOdd, RefusesBadPosesAndSettings) {
    const Tree ball = build(scenes::sphere(1, 3).view());
    CrossingQuery query(ball, ball);
    Crossing crossing;
    const auto expectRefused = [&](const Pose& pose, const CrossingSettings& settings) {
        query.find({}, {}, {2}, crossing);
        ASSERT_EQ(crossing.stop, StopReason::budget);
        query.find(pose, settings, {}, crossing);
        for (int again = 0; again < 2; ++again) {
            EXPECT_EQ(crossing.stop, StopReason::invalidInput);
            EXPECT_TRUE(crossing.pieces.empty());
            EXPECT_FALSE(crossing.certain);
            EXPECT_EQ(crossing.work, 0U);
            query.resume({}, crossing);
        }
    };
    for (const float leaveOut : {nan, -0.01F, 1.01F, infinity, -infinity}) {
        expectRefused({}, {.leaveOut = leaveOut});
    }
    for (const float bad : {nan, infinity, -infinity}) {
        expectRefused({Eigen::Matrix3f::Identity(), {0, bad, 0}}, {});
        Pose pose;
        pose.rotation(1, 2) = bad;
        expectRefused(pose, {});
    }
    expectRefused({2 * Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero()}, {});
    expectRefused({Eigen::Vector3f(1, 1, -1).asDiagonal(), Eigen::Vector3f::Zero()}, {});
    expectRefused({Eigen::Matrix3f::Zero(), Eigen::Vector3f::Zero()}, {});
}

TEST(CrossingOdd, NothingToResume) {
    const Tree ball = build(scenes::sphere(1, 3).view());
    CrossingQuery query(ball, ball);
    Crossing crossing;
    crossing.pieces.resize(3);
    query.resume({}, crossing);
    EXPECT_EQ(crossing.stop, StopReason::invalidInput);
    EXPECT_TRUE(crossing.pieces.empty());
    CrossingQuery copy(query);
    copy.resume({}, crossing);
    EXPECT_EQ(crossing.stop, StopReason::invalidInput);
    query.find({Eigen::Matrix3f::Identity(), {0.5F, 0, 0}}, {}, {5}, crossing);
    EXPECT_EQ(crossing.stop, StopReason::budget);
    query.forget();
    query.resume({}, crossing);
    EXPECT_EQ(crossing.stop, StopReason::invalidInput);
}

TEST(CrossingOdd, NoBudgetSaysWhatIsKnown) {
    const Tree ball = build(scenes::sphere(1, 6).view());
    CrossingQuery query(ball, ball);
    Crossing crossing;
    for (const Budget& none :
         {Budget{0}, Budget{unlimited, std::chrono::nanoseconds(0)}, Budget{unlimited, std::chrono::nanoseconds(-5)}}) {
        query.find({Eigen::Matrix3f::Identity(), {0.5F, 0, 0}}, {}, none, crossing);
        EXPECT_EQ(crossing.stop, StopReason::budget);
        EXPECT_EQ(crossing.work, 0U);
        EXPECT_TRUE(crossing.pieces.empty());
        query.resume({4}, crossing);
        EXPECT_EQ(crossing.work, 4U);
        EXPECT_FALSE(crossing.pieces.empty());
        const std::size_t known = crossing.pieces.size();
        query.resume(none, crossing);
        EXPECT_EQ(crossing.work, 4U);
        EXPECT_EQ(crossing.pieces.size(), known);
    }
}

std::chrono::nanoseconds microsecondClock() noexcept {
    static std::chrono::nanoseconds now{0};
    now += std::chrono::nanoseconds(1000);
    return now;
}

TEST(CrossingOdd, TimeIsLookedAtEvery32Units) {
    const Tree bumpy = build(scenes::bumpySphere(1, 0.25F, 6, 10).view());
    const Pose pose{Eigen::Matrix3f::Identity(), {0.3F, 0, 0}};
    const Crossing all = exactCrossing(bumpy, bumpy, pose);
    ASSERT_GT(all.work, 200U);
    CrossingQuery query(bumpy, bumpy);
    Crossing crossing;
    query.find(pose, {.leaveOut = 0}, {unlimited, std::chrono::nanoseconds(3000), &microsecondClock}, crossing);
    EXPECT_EQ(crossing.stop, StopReason::budget);
    EXPECT_EQ(crossing.work, 96U);
    EXPECT_TRUE(same(crossing, crossingAfter(bumpy, bumpy, pose, 96)));
    query.resume({40, std::chrono::nanoseconds(1'000'000), &microsecondClock}, crossing);
    EXPECT_EQ(crossing.work, 136U);
    query.resume({unlimited, std::chrono::hours(1)}, crossing);
    EXPECT_TRUE(same(crossing, all));
}

}  // namespace
}  // namespace grapeshot::test
