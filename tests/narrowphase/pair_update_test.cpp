#include <grapeshot/narrowphase/pair_update.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "narrowphase/pair_states.hpp"
#include "scenes/shapes.hpp"
#include "support/poses.hpp"
#include "support/test_size.hpp"

namespace grapeshot {
namespace {

using Eigen::Vector3f;
using test::Random;

MeshModel modelOf(const scenes::Mesh& mesh) {
    return makeModel(mesh.view());
}

Pose posed(const Vector3f& translation, const Eigen::AngleAxisf& turn = Eigen::AngleAxisf::Identity()) {
    return {turn.toRotationMatrix(), translation};
}

std::vector<PersistentPoint> pointsOf(const PairState& state) {
    std::vector<PersistentPoint> points;
    for (const RegionSlot& slot : state.contacts.slots) {
        points.insert(points.end(), slot.points.begin(), slot.points.begin() + slot.count);
    }
    return points;
}

std::vector<std::uint32_t> idsOf(const PairState& state) {
    std::vector<std::uint32_t> ids;
    for (const RegionSlot& slot : state.contacts.slots) {
        if (slot.id != 0) {
            ids.push_back(slot.id);
        }
    }
    return ids;
}

/// The contacts of a face are one region, though its corners are far apart.
PairSettings coarse() {
    PairSettings settings;
    settings.set.regions.spacing = 0.7F;
    return settings;
}

/// A body rolls, slides and rocks on another.
Pose onPath(float t, float height) {
    return posed({0.004F * t, height + 0.02F * std::sin(0.13F * t), 0.05F * std::sin(0.05F * t)},
                 Eigen::AngleAxisf(0.02F * t, Vector3f(0.3F * std::sin(0.01F * t), 1, 0.2F).normalized()));
}

struct Pair {
    const char* name;
    MeshModel a, b;
    float height;  ///< of B's middle when it touches A, roughly
};

std::vector<Pair> pairs() {
    std::vector<Pair> all;
    all.push_back({"blocks", modelOf(scenes::box({1, 0.5F, 1}, 8)), modelOf(scenes::box({0.3F, 0.2F, 0.4F}, 5)), 0.7F});
    all.push_back(
        {"tori", modelOf(scenes::torus(0.6F, 0.2F, 28, 12)), modelOf(scenes::torus(0.5F, 0.15F, 28, 12)), 0.33F});
    all.push_back(
        {"ball in cup", modelOf(scenes::cup(0.6F, 0.1F, 0.6F, 24, 7)), modelOf(scenes::sphere(0.3F, 4)), 0.1F});
    return all;
}

TEST(PairUpdate, TellsTouchingFromClear) {
    const MeshModel floor = modelOf(scenes::box({1, 0.5F, 1}, 4));
    const MeshModel ball = modelOf(scenes::sphere(0.25F, 6));
    for (const float gap : {0.2F, 0.05F, 0.001F, -0.001F, -0.05F, -0.2F}) {
        // A corner of the ball points down, so the gap is exact.
        PairState state;
        const float lowest = -ball.tree.lower.y();
        const PairResult result = update(floor, ball, posed({0.1F, 0.5F + lowest + gap, 0}), {}, {}, state);
        EXPECT_TRUE(result.certain);
        EXPECT_EQ(result.stop, StopReason::certain);
        EXPECT_EQ(result.collides, gap < 0) << gap;
        const auto points = pointsOf(state);
        EXPECT_EQ(points.empty(), gap > 0.06F);
        if (!points.empty()) {
            EXPECT_NEAR(points.front().signedDistance, gap, 0.01F) << gap;
            EXPECT_LT(points.front().normalInB.y(), -0.9F);
        }
    }
}

TEST(PairUpdate, KeptCandidatesGiveTheSameBytesAsAFreshTraversal) {
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        PairSettings fresh, kept;
        fresh.slack = 0;
        kept.slack = 0.05F;
        PairState freshState, keptState;
        std::size_t traversals = 0, contacts = 0;
        const int steps = static_cast<int>(test::sampleSize(100, 1000));
        for (int i = 0; i < steps; ++i) {
            const Pose pose = onPath(static_cast<float>(i), pair.height);
            const PairResult one = update(pair.a, pair.b, pose, fresh, {}, freshState);
            const PairResult other = update(pair.a, pair.b, pose, kept, {}, keptState);
            ASSERT_TRUE(test::sameContacts(freshState, keptState)) << "step " << i;
            EXPECT_EQ(one.rawContacts, other.rawContacts);
            EXPECT_EQ(one.collides, other.collides);
            EXPECT_TRUE(one.traversed);
            traversals += other.traversed ? 1U : 0U;
            contacts += one.rawContacts;
        }
        EXPECT_GT(contacts, 100U);
        EXPECT_GT(traversals, 1U);
        EXPECT_LT(traversals, static_cast<std::size_t>(steps) * 2 / 3);
    }
}

TEST(PairUpdate, SameBytesTwiceAndFromACopy) {
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        const PairSettings settings;
        PairState first, second, copy;
        for (int i = 0; i < 60; ++i) {
            update(pair.a, pair.b, onPath(static_cast<float>(i), pair.height), settings, {}, first);
        }
        for (int i = 0; i < 60; ++i) {
            if (i == 31) {
                copy = second;
            }
            // Other pairs between, on the same thread.
            PairState other;
            update(pair.b, pair.a, inverse(onPath(2 * i, pair.height)), settings, {}, other);
            update(pair.a, pair.b, onPath(static_cast<float>(i), pair.height), settings, {}, second);
        }
        for (int i = 31; i < 60; ++i) {
            update(pair.a, pair.b, onPath(static_cast<float>(i), pair.height), settings, {}, copy);
        }
        EXPECT_FALSE(pointsOf(first).empty());
        EXPECT_TRUE(test::sameContacts(first, second));
        EXPECT_TRUE(test::sameContacts(first, copy));
        EXPECT_EQ(first.candidates, copy.candidates);
        EXPECT_EQ(first.step, copy.step);
    }
}

TEST(PairUpdate, MoreBudgetIsNeverWorseAndEnoughIsTheSameAsUnlimited) {
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        for (const int step : {0, 20, 45}) {
            const Pose pose = onPath(step, pair.height - 0.02F);
            PairState whole;
            const PairResult all = update(pair.a, pair.b, pose, {}, {}, whole);
            ASSERT_TRUE(all.certain);
            ASSERT_GT(all.work, 4U);
            std::uint32_t before = 0;
            for (std::uint64_t work = 0; work <= 2 * all.work + 2; work += 1 + work / 5) {
                PairState state;
                const PairResult result = update(pair.a, pair.b, pose, {}, {.work = work}, state);
                EXPECT_LE(result.work, work);
                EXPECT_GE(result.candidates, before) << "tested at " << work;
                before = result.candidates;
                if (result.certain) {
                    EXPECT_TRUE(test::sameContacts(state, whole));
                    EXPECT_EQ(state.candidates, whole.candidates);
                    EXPECT_EQ(result.collides, all.collides);
                } else {
                    EXPECT_EQ(result.stop, StopReason::budget);
                    EXPECT_LT(work, 2 * all.work);
                    if (state.candidateDistance >= 0) {  // all are known, not all tested
                        EXPECT_EQ(state.candidates, whole.candidates);
                    }
                }
            }
            PairState state;
            EXPECT_TRUE(update(pair.a, pair.b, pose, {}, {.work = 2 * all.work}, state).certain);
        }
    }
}

TEST(PairUpdate, OutOfBudgetKeepsWhatItKnows) {
    const MeshModel floor = modelOf(scenes::box({1, 0.5F, 1}, 8));
    const MeshModel block = modelOf(scenes::box({0.3F, 0.2F, 0.3F}, 4));
    PairState state;
    update(floor, block, posed({0, 0.705F, 0}), coarse(), {}, state);
    const auto before = pointsOf(state);
    ASSERT_EQ(before.size(), 4U);
    for (int i = 0; i < 5; ++i) {
        const PairResult result = update(floor, block, posed({0, 0.699F, 0}), coarse(), {.work = 0}, state);
        EXPECT_FALSE(result.certain);
        EXPECT_EQ(result.stop, StopReason::budget);
        EXPECT_EQ(result.work, 0U);
        EXPECT_TRUE(result.collides) << "the kept points say so";
    }
    const auto after = pointsOf(state);
    ASSERT_EQ(after.size(), before.size());
    for (const PersistentPoint& point : after) {
        EXPECT_NEAR(point.signedDistance, -0.001F, 1e-5);
        EXPECT_EQ(point.age, 5U);
    }
    EXPECT_TRUE(update(floor, block, posed({0, 0.699F, 0}), coarse(), {}, state).certain);
    EXPECT_EQ(idsOf(state), std::vector<std::uint32_t>{1});
}

/// The smallest slices get to the end, as long as the bodies hardly move: traversal and tests go on where they stopped.
TEST(PairUpdate, WhatIsCutShortGoesOnInTheNextStep) {
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        const Pose pose = onPath(20, pair.height - 0.01F);
        PairState whole;
        const PairResult all = update(pair.a, pair.b, pose, {}, {}, whole);
        ASSERT_GT(all.work, 60U);
        for (const std::uint64_t slice : {8U, 20U}) {
            PairState state;
            std::uint64_t steps = 0;
            std::uint64_t work = 0;
            while (state.candidateDistance < 0 && steps < all.work) {
                work += update(pair.a, pair.b, pose, {}, {.work = slice}, state).work;
                ++steps;
            }
            EXPECT_EQ(state.candidates, whole.candidates) << "after " << steps << " steps of " << slice;
            EXPECT_LT(work, 4 * all.work);
            // Half of a slice may go into what is known.
            for (std::uint64_t round = 0; round < 3 * all.work / (slice / 2 - 3); ++round) {
                EXPECT_LE(update(pair.a, pair.b, pose, {}, {.work = slice}, state).work, slice);
            }
            const auto deepestOf = [](const PairState& of) {
                float deepest = 1;
                for (const PersistentPoint& point : pointsOf(of)) {
                    deepest = std::min(deepest, point.signedDistance);
                }
                return deepest;
            };
            // The deepest was found on the way. A stand-in or half a cut may go a little deeper.
            EXPECT_LT(deepestOf(state), deepestOf(whole) + 0.2F * std::abs(deepestOf(whole)) + 1e-4F);
            EXPECT_GT(deepestOf(state),
                      std::min(1.2F * deepestOf(whole), 0.0F) - PairSettings().maxDistance / 4 - 1e-3F);
        }
    }
}

TEST(PairUpdate, ACopyOfWhatWasCutShortGoesOnTheSame) {
    for (const Pair& pair : pairs()) {
        PairState state;
        PairState copy;
        for (int i = 0; i < 30; ++i) {
            const Pose pose = onPath(0.1F * static_cast<float>(i), pair.height - 0.01F);
            update(pair.a, pair.b, pose, {}, {.work = 12}, state);
            if (i == 3) {
                EXPECT_TRUE(state.traversal.has_value());
                copy = state;
            } else if (i > 3) {
                update(pair.a, pair.b, pose, {}, {.work = 12}, copy);
                ASSERT_TRUE(test::sameContacts(state, copy)) << i;
                EXPECT_EQ(state.candidates, copy.candidates);
            }
        }
    }
}

TEST(PairUpdate, TimeIsASecondStopByTheGivenClock) {
    const Pair pair = std::move(pairs()[1]);
    const Pose pose = onPath(10, pair.height - 0.05F);
    PairState whole;
    update(pair.a, pair.b, pose, {}, {}, whole);
    bool stopped = false, finished = false;
    for (const int us : {0, 1, 10, 100, 1000, 100000}) {
        PairState state;
        Budget budget;
        budget.time = std::chrono::microseconds(us);
        budget.clock = test::tick;
        const PairResult result = update(pair.a, pair.b, pose, {}, budget, state);
        (result.certain ? finished : stopped) = true;
        if (result.certain) {
            EXPECT_TRUE(test::sameContacts(state, whole));
        }
    }
    EXPECT_TRUE(stopped);
    EXPECT_TRUE(finished);
}

TEST(PairUpdate, BadPosesAndSettingsClearAndReportNothing) {
    const MeshModel floor = modelOf(scenes::box({1, 0.5F, 1}, 2));
    const MeshModel block = modelOf(scenes::box({0.3F, 0.2F, 0.3F}, 2));
    const Pose good = posed({0, 0.705F, 0});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Pose> bad(5, good);
    bad[0].translation.x() = nan;
    bad[1].rotation(1, 1) = nan;
    bad[2].translation.y() = std::numeric_limits<float>::infinity();
    bad[3].rotation *= 2;
    bad[4].rotation.col(0) *= -1;
    PairState state;
    std::uint32_t last = 0;
    for (const Pose& pose : bad) {
        update(floor, block, good, coarse(), {}, state);
        ASSERT_EQ(idsOf(state).size(), 1U);
        EXPECT_GT(idsOf(state)[0], last) << "names are not reused";
        last = idsOf(state)[0];
        const PairResult result = update(floor, block, pose, {}, {}, state);
        EXPECT_EQ(result.stop, StopReason::invalidInput);
        EXPECT_FALSE(result.collides);
        EXPECT_FALSE(result.certain);
        EXPECT_TRUE(pointsOf(state).empty());
    }
    PairSettings settings;
    settings.maxDistance = nan;
    EXPECT_EQ(update(floor, block, good, settings, {}, state).stop, StopReason::invalidInput);
    settings = {};
    settings.set.mergeDistance = 0;
    EXPECT_EQ(update(floor, block, good, settings, {}, state).stop, StopReason::invalidInput);
    settings = {};
    settings.slack = -1;
    EXPECT_EQ(update(floor, block, good, settings, {}, state).stop, StopReason::invalidInput);
}

TEST(PairUpdate, ARestingBlockStandsOnItsFourCornersFromStepToStep) {
    const MeshModel floor = modelOf(scenes::box({1, 0.5F, 1}, 9));
    const MeshModel block = modelOf(scenes::box({0.3F, 0.2F, 0.25F}, 12));
    Random random(3);
    PairState state;
    for (int i = 0; i < 100; ++i) {
        const auto noise = [&] { return static_cast<float>(random.uniform(-1e-4, 1e-4)); };
        const Pose pose =
            posed({0.03F + noise(), 0.705F + noise(), noise()}, Eigen::AngleAxisf(noise(), random.direction()));
        update(floor, block, pose, coarse(), {}, state);
        ASSERT_EQ(idsOf(state), std::vector<std::uint32_t>{1});
        const auto points = pointsOf(state);
        ASSERT_EQ(points.size(), 4U);
        for (const PersistentPoint& point : points) {
            EXPECT_NEAR(std::abs(point.localB.x()), 0.3F, 1e-3);
            EXPECT_NEAR(std::abs(point.localB.z()), 0.25F, 1e-3);
            EXPECT_EQ(point.age, static_cast<std::uint32_t>(i));
        }
    }
}

TEST(PairUpdate, DeepBodiesArePushedOutOverTheSteps) {
    // Each step the body moves by 0.3 of the mean of what its contacts ask for.
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        Random random(4);
        std::size_t out = 0, deep = 0;
        const std::size_t trials = test::sampleSize(12, 100);
        for (std::size_t trial = 0; trial < trials;) {
            Pose pose = test::randomPose(pair.a.tree, pair.b.tree, random);
            PairState state;
            PairResult result = update(pair.a, pair.b, pose, {}, {}, state);
            if (!result.collides) {
                continue;
            }
            ++trial;
            deep += result.deepContacts > 0 ? 1U : 0U;
            for (int step = 0; step < 60 && result.collides; ++step) {
                Vector3f push = Vector3f::Zero();
                for (const PersistentPoint& point : pointsOf(state)) {
                    ASSERT_TRUE(point.localA.allFinite() && point.normalInB.allFinite());
                    const Vector3f normal = pose.rotation * point.normalInB;
                    const float wanted = -point.signedDistance - push.dot(-normal);
                    push -= std::max(0.0F, 0.4F * wanted + 0.001F) * normal;
                }
                pose.translation += push;
                result = update(pair.a, pair.b, pose, {}, {}, state);
            }
            out += result.collides ? 0U : 1U;
        }
        EXPECT_GT(deep, trials / 3);
        EXPECT_GE(out, trials * 8 / 10);
    }
}

TEST(PairUpdate, ASolidInsideASolidCollidesASurfaceDoesNot) {
    const MeshModel big = modelOf(scenes::sphere(1, 6));
    const MeshModel small = modelOf(scenes::sphere(0.1F, 2));
    PairSettings settings;
    for (const auto interior : {Interior::solid, Interior::surface}) {
        settings.interior = interior;
        PairState there, back;
        const Pose pose = posed({0.3F, 0.2F, 0.1F});
        EXPECT_EQ(update(big, small, pose, settings, {}, there).collides, interior == Interior::solid);
        EXPECT_EQ(update(small, big, inverse(pose), settings, {}, back).collides, interior == Interior::solid);
        EXPECT_EQ(pointsOf(there).size(), interior == Interior::solid ? 1U : 0U);
        EXPECT_EQ(pointsOf(back).size(), interior == Interior::solid ? 1U : 0U);
    }
}

float deepest(const PairState& state) {
    float depth = -std::numeric_limits<float>::max();
    for (const PersistentPoint& point : pointsOf(state)) {
        depth = std::max(depth, -point.signedDistance);
    }
    return depth;
}

TEST(PairUpdate, WhatIsReusedIsNeverLateAndNeverFarOff) {
    int refreshed = 0;
    int searched = 0;
    int touching = 0;
    for (const Pair& pair : pairs()) {
        SCOPED_TRACE(pair.name);
        PairSettings exact = coarse();
        PairSettings reusing = exact;
        reusing.reuseMotion = 0.01F;
        PairState truth;
        PairState state;
        std::uint64_t work = 0;
        std::uint64_t exactWork = 0;
        for (int i = 0; i < 600; ++i) {
            const Pose pose = onPath(0.05F * static_cast<float>(i), pair.height);
            const PairResult full = update(pair.a, pair.b, pose, exact, {}, truth);
            const PairResult result = update(pair.a, pair.b, pose, reusing, {}, state);
            work += result.work;
            exactWork += full.work;
            EXPECT_TRUE(result.certain);
            (result.refreshed ? refreshed : searched) += 1;
            if (result.refreshed) {
                EXPECT_EQ(result.work, 0U);
            }
            if (full.deepContacts == 0 && deepest(truth) > reusing.reuseMotion - reusing.maxDistance) {
                ++touching;
                EXPECT_NEAR(deepest(state), deepest(truth), reusing.reuseMotion) << "step " << i;
            }
        }
        EXPECT_LT(work, exactWork);
    }
    EXPECT_GT(refreshed, 500);
    EXPECT_GT(searched, 100);
    EXPECT_GT(touching, 500);
}

TEST(PairUpdate, NothingIsReusedWhereSurfacesCutOrTheBudgetEnded) {
    const MeshModel ball = modelOf(scenes::bumpySphere(0.5F, 0.1F, 5, 8));
    PairSettings settings;
    settings.reuseMotion = 0.02F;
    PairState cutting;
    const Pose deep = posed({0.7F, 0, 0});
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(update(ball, ball, deep, settings, {}, cutting).refreshed);
    }
    PairState starved;
    const Pose apart = posed({1.03F, 0, 0});
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(update(ball, ball, apart, settings, {.work = 2}, starved).refreshed);
    }
    EXPECT_FALSE(update(ball, ball, apart, settings, {}, starved).refreshed);
    EXPECT_TRUE(update(ball, ball, apart, settings, {}, starved).refreshed);
    // More is asked for than was searched.
    settings.maxDistance *= 1.5F;
    settings.set.maxDistance *= 1.5F;
    EXPECT_FALSE(update(ball, ball, apart, settings, {}, starved).refreshed);
    EXPECT_TRUE(update(ball, ball, apart, settings, {}, starved).refreshed);
    // A point slid away: whatever has come in its place is to be found.
    settings.set.mergeDistance = 1e-4F;
    EXPECT_FALSE(update(ball, ball, posed({1.03F, 1e-3F, 0}), settings, {}, starved).refreshed);
    settings.reuseMotion = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(update(ball, ball, apart, settings, {}, starved).stop, StopReason::invalidInput);
}

}  // namespace
}  // namespace grapeshot
