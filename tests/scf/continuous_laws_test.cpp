// Laws of impacts: swapped bodies, moved scenes, time run backwards, same bytes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include <grapeshot/core/bytes.hpp>

#include <adb/meshes.hpp>
#include <scf/continuous_scenes.hpp>

namespace grapeshot::test {
namespace {

TEST(ImpactLaws, SwappedBodiesMeetAtTheSameTime) {
    const PassingPair scene;
    int hits = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const ImpactResult one = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fineSettings);
        const ImpactResult two = ImpactQuery(scene.b, scene.a).find(event.b.motion(), event.a.motion(), fineSettings);
        ASSERT_EQ(one.impact.has_value(), two.impact.has_value());
        if (one.impact) {
            ++hits;
            EXPECT_NEAR(one.impact->time, two.impact->time, 2e-5);
            EXPECT_LE((one.impact->normal + two.impact->normal).norm(), one.impact->time > 0 ? 0.05F : 3);
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_LT(hits, 35);
}

TEST(ImpactLaws, MovedAsAWholeItIsTheSameImpact) {
    const PassingPair scene;
    Random random(17);
    int hits = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        const ImpactResult plain = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fineSettings);
        const RigidMotion frame{{random.rotation(), 2 * random.direction()}, 2 * random.direction(), {0, 0, 0}};
        SurfaceMotion a = event.a.motion();
        SurfaceMotion b = event.b.motion();
        a.frame = b.frame = frame;
        const ImpactResult moved = ImpactQuery(scene.a, scene.b).find(a, b, fineSettings);
        ASSERT_EQ(plain.impact.has_value(), moved.impact.has_value());
        if (plain.impact) {
            ++hits;
            EXPECT_NEAR(plain.impact->time, moved.impact->time, 5e-5);
        }
        // Likewise when the frame that both stand in turns.
        a.frame.turn = b.frame.turn = random.direction();
        const ImpactResult turned = ImpactQuery(scene.a, scene.b).find(a, b, fineSettings);
        ASSERT_EQ(plain.impact.has_value(), turned.impact.has_value());
        if (plain.impact) {
            EXPECT_NEAR(plain.impact->time, turned.impact->time, 5e-5);
        }
    }
    EXPECT_GT(hits, 8);
    EXPECT_LT(hits, 28);
}

TEST(ImpactLaws, RunBackwardsItHitsAsWell) {
    const PassingPair scene;
    int hits = 0;
    int clear = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const PassingPair::Event event = scene.event(seed);
        MovingBody a = event.a;
        MovingBody b = event.b;
        std::swap(a.before, a.now);
        std::swap(b.before, b.now);
        const ImpactResult there = ImpactQuery(scene.a, scene.b).find(event.a.motion(), event.b.motion(), fineSettings);
        const ImpactResult back = ImpactQuery(scene.a, scene.b).find(a.motion(), b.motion(), fineSettings);
        ASSERT_EQ(there.impact.has_value(), back.impact.has_value());
        if (there.impact) {
            // The last touch cannot be before the first one.
            EXPECT_LE(there.impact->time, 1 - back.impact->time + 1e-5F);
            ++hits;
        } else {
            ++clear;
        }
    }
    EXPECT_GT(hits, 10);
    EXPECT_GT(clear, 5);
}

TEST(ImpactLaws, WithoutMotionThereIsTheStartAlone) {
    const PassingPair scene;
    ImpactQuery query(scene.a, scene.b);
    int touching = 0;
    for (int i = 0; i < 20; ++i) {
        const Pose pose{Eigen::Matrix3f::Identity(), {0.25F + 0.04F * static_cast<float>(i), 0.1F, 0}};
        const bool truth = bruteForceDecide(scene.meshA.view(), scene.meshB.view(), pose);
        const ImpactResult result = query.find(rigidMotion(), rigidMotion({pose, {0, 0, 0}, {0, 0, 0}}), fineSettings);
        ASSERT_TRUE(result.certain);
        ASSERT_EQ(result.impact.has_value(), truth);
        EXPECT_EQ(result.freeUntil, truth ? 0 : 1);
        touching += truth ? 1 : 0;
        // One that touches at the start does so whatever it does then.
        const ImpactResult moving = query.find(rigidMotion(), rigidMotion({pose, {3, 0, 0}, {0, 1, 0}}), fineSettings);
        EXPECT_EQ(moving.impact && moving.impact->time == 0, truth);
    }
    EXPECT_GT(touching, 3);
    EXPECT_LT(touching, 17);
}

std::vector<std::byte> bytesOf(const ImpactResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    writer.put(result.freeUntil);
    writer.put(result.certain);
    writer.put(result.work);
    writer.put(result.miss.unknown);
    writer.put(result.miss.hits);
    writer.put(result.miss.missedBound);
    if (result.impact) {
        writer.put(result.impact->time);
        writer.put(result.impact->pair.triangleA);
        writer.put(result.impact->pair.triangleB);
        writer.put(result.impact->featureA);
        writer.put(result.impact->featureB);
        writer.put(result.impact->onA);
        writer.put(result.impact->onB);
        writer.put(result.impact->normal);
    }
    return bytes;
}

TEST(ImpactLaws, SameBytesOnEveryInstructionSetAndAgain) {
    const InstructionSetGuard guard;
    const PassingPair scene;
    std::vector<std::vector<std::byte>> expected;
    for (int run = 0; run < 2; ++run) {
        for (const InstructionSet set : instructionSets()) {
            limitInstructionSet(set);
            ImpactQuery query(scene.a, scene.b);
            std::vector<std::vector<std::byte>> all;
            std::size_t hits = 0;
            for (std::uint64_t seed = 0; seed < 12; ++seed) {
                const PassingPair::Event event = scene.event(seed);
                SurfaceMotion turning = event.b.motion();
                turning.frame.turn = {0, 0.4F, 0};
                for (const std::uint64_t work : {std::uint64_t{40}, unlimited}) {
                    for (const SurfaceMotion& b : {event.b.motion(), turning}) {
                        const ImpactResult result = query.find(event.a.motion(), b, fineSettings, {.work = work});
                        hits += result.impact ? 1 : 0;
                        all.push_back(bytesOf(result));
                    }
                }
            }
            expected = expected.empty() ? all : expected;
            EXPECT_EQ(all, expected);
            EXPECT_GE(hits, 8U);
        }
    }
}

TEST(ImpactLaws, DiscreteQueriesMissWhatPassesThrough) {
    // A needle through a sheet: neither end of the step touches.
    const scenes::Mesh sheet = scenes::grid(1, 1, 30, 30);
    const scenes::Mesh needle = scenes::box({0.003F, 0.05F, 0.003F}, 1);
    const BallTree a = buildBallTree(sheet.view());
    const BallTree b = buildBallTree(needle.view());
    const Pose above{Eigen::Matrix3f::Identity(), {0.013F, 0.9F, 0.022F}};
    const Pose below{Eigen::Matrix3f::Identity(), {0.013F, -0.7F, 0.022F}};
    EXPECT_FALSE(bruteForceDecide(sheet.view(), needle.view(), above));
    EXPECT_FALSE(bruteForceDecide(sheet.view(), needle.view(), below));
    ImpactQuery query(a, b);
    const ImpactResult through = query.find(rigidMotion(), rigidMotion(motionBetween(above, below)), fineSettings);
    ASSERT_TRUE(through.impact);
    EXPECT_NEAR(through.impact->time, 0.85 / 1.6, 2e-6);
    EXPECT_NEAR(std::abs(through.impact->normal[1]), 1, 1e-3);
    RigidMotion beside = motionBetween(above, below);
    beside.from.translation[0] += 1;
    EXPECT_FALSE(query.find(rigidMotion(), rigidMotion(beside), fineSettings).impact);
    // Thickness: the sheet's is reached before the sheet.
    ImpactSettings thick = fineSettings;
    thick.maxDistance = 0.1F;
    const ImpactResult earlier = query.find(rigidMotion(), rigidMotion(motionBetween(above, below)), thick);
    ASSERT_TRUE(earlier.impact);
    EXPECT_NEAR(earlier.impact->time, 0.75 / 1.6, 1e-5);
}

TEST(ImpactLaws, MotionsLeadWhereTheyShould) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const Pose from{random.rotation(), random.direction()};
        const Pose to{random.rotation(), random.direction()};
        const RigidMotion motion = motionBetween(from, to);
        EXPECT_LE(motion.turn.norm(), std::numbers::pi_v<float> + 1e-5F);
        const Pose end = poseAt(motion, 1);
        EXPECT_LE((end.rotation - to.rotation).norm(), 2e-6F);
        EXPECT_LE((end.translation - to.translation).norm(), 1e-6F);
        // Half way from both sides, at a constant rate.
        const Pose half = poseAt(motion, 0.5);
        const RigidMotion rest = motionBetween(half, to);
        EXPECT_LE((rest.turn - 0.5F * motion.turn).norm(), 1e-5F);
    }
    const RigidMotion whole{{}, {0, 0, 0}, {0, 0, 2 * std::numbers::pi_v<float>}};
    EXPECT_LE((poseAt(whole, 1).rotation - Eigen::Matrix3f::Identity()).norm(), 1e-6F);
    EXPECT_NEAR(poseAt(whole, 0.25).rotation(1, 0), 1, 1e-6);
}

}  // namespace
}  // namespace grapeshot::test
