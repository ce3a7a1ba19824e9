// What a tracker reports, in all modes, against every pair of triangles.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

std::vector<TrianglePair> pairsOf(const TrackResult& result) {
    std::vector<TrianglePair> pairs;
    for (const TrackedContact& contact : result.contacts) {
        pairs.push_back(contact.pair);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// Every contact is one: distances and witness points by the oracle.
void expectTrue(const TrackResult& result, MeshView a, MeshView b, double maxDistance) {
    for (const TrackedContact& contact : result.contacts) {
        const Corners cornersA = cornersOf(a, contact.pair.triangleA);
        const Corners cornersB = cornersOf(b, contact.pair.triangleB);
        const double distance = triangleDistance(cornersA, cornersB);
        EXPECT_LE(distance, maxDistance + 2e-6);
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-5F);
        if (!contact.overlapping) {
            EXPECT_NEAR(contact.signedDistance, distance, 2e-6);
            EXPECT_NEAR((contact.onA - contact.onB).norm(), distance, 2e-6);
            if (distance > 1e-4) {
                EXPECT_GT(contact.normal.dot(contact.onA - contact.onB), 0);
            }
        } else {
            EXPECT_LE(contact.signedDistance, 0);
        }
    }
}

TEST(Tracker, ExactFindsWhatBruteForceFinds) {
    const TwoBumpy scene;
    Tracker tracker(scene.a, scene.b);
    std::size_t total = 0;
    for (int frame = 0; frame < 30; frame += 6) {
        const TwoBumpy::Frame where = scene.at(frame);
        const TrackResult result = tracker.step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::exact));
        EXPECT_TRUE(result.certain);
        EXPECT_EQ(result.stop, StopReason::certain);
        EXPECT_EQ(result.fault, std::nullopt);
        EXPECT_EQ(result.tracked, 0U);
        const MeshView a{where.a, scene.meshA.triangles};
        const MeshView b{where.b, scene.meshB.triangles};
        expectTrue(result, a, b, 0.02);
        const auto found = pairsOf(result);
        std::vector<TrianglePair> different;
        std::ranges::set_symmetric_difference(found, bruteForcePairs(a, b, {}, 0.02), std::back_inserter(different));
        for (const TrianglePair& pair : different) {
            EXPECT_NEAR(triangleDistance(cornersOf(a, pair.triangleA), cornersOf(b, pair.triangleB)), 0.02, 2e-6);
        }
        total += found.size();
    }
    EXPECT_GT(total, 200U);
}

/// Pairs of cells of the spacing that hold a pair of triangles.
std::set<std::pair<std::uint32_t, std::uint32_t>> cellPairs(const std::vector<TrianglePair>& pairs,
                                                            const detail::Cells& cellsA, const BallTree& a,
                                                            const detail::Cells& cellsB, const BallTree& b) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> cells;
    for (const TrianglePair& pair : pairs) {
        auto first = cellsA.cellOf(a, pair.triangleA);
        auto second = cellsB.cellOf(b, pair.triangleB);
        if (&a == &b && first > second) {
            std::swap(first, second);
        }
        cells.insert({first, second});
    }
    return cells;
}

TEST(Tracker, AtAResolutionEveryPairOfCellsIsRepresented) {
    const TwoBumpy scene(24);
    Tracker exact(scene.a, scene.b);
    Tracker tracker(scene.a, scene.b);
    const detail::Cells cellsA = detail::cellsOfRadius(scene.a, 0.1F);
    const detail::Cells cellsB = detail::cellsOfRadius(scene.b, 0.1F);
    std::size_t all = 0;
    std::size_t reported = 0;
    for (int frame = 0; frame < 40; frame += 2) {
        const TwoBumpy::Frame where = scene.at(frame);
        const auto truth = exact.step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::exact));
        const auto result = tracker.step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::resolution));
        EXPECT_TRUE(result.certain);
        EXPECT_EQ(cellPairs(pairsOf(result), cellsA, scene.a, cellsB, scene.b),
                  cellPairs(pairsOf(truth), cellsA, scene.a, cellsB, scene.b));
        EXPECT_TRUE(std::ranges::includes(pairsOf(truth), pairsOf(result)));
        all += truth.contacts.size();
        reported += result.contacts.size();
    }
    EXPECT_GT(reported, 50U);
    EXPECT_LT(3 * reported, all);
}

TEST(Tracker, OfABodyWithItselfInAllModes) {
    const Roll roll;
    Tracker exact(roll.tree);
    Tracker resolved(roll.tree);
    Tracker sampled(roll.tree);
    const detail::Cells cells = detail::cellsOfRadius(roll.tree, 0.2F);
    std::size_t total = 0;
    for (int frame = 0; frame < 6; ++frame) {
        const std::vector<Eigen::Vector3f> positions = roll.at(frame);
        const SurfaceState state{positions, {}, Stretch::measured(), {}};
        const TrackResult truth = exact.step(state, Roll::settings(TrackMode::exact));
        ASSERT_TRUE(truth.certain);
        const MeshView mesh{positions, roll.mesh.triangles};
        expectTrue(truth, mesh, mesh, 0.28);
        for (const TrackedContact& contact : truth.contacts) {
            EXPECT_LT(contact.pair.triangleA, contact.pair.triangleB);
        }
        const auto pairs = pairsOf(truth);
        EXPECT_EQ(std::set(pairs.begin(), pairs.end()).size(), pairs.size());
        const TrackResult result = resolved.step(state, Roll::settings(TrackMode::resolution));
        EXPECT_TRUE(result.certain);
        EXPECT_EQ(cellPairs(pairsOf(result), cells, roll.tree, cells, roll.tree),
                  cellPairs(pairs, cells, roll.tree, cells, roll.tree));
        const TrackResult some = sampled.step(state, Roll::settings(TrackMode::budget), {.work = 3000});
        EXPECT_TRUE(std::ranges::includes(pairs, pairsOf(some)));
        EXPECT_FALSE(some.contacts.empty());
        total += pairs.size();
    }
    EXPECT_GT(total, 1000U);
}

TEST(Tracker, WithoutALimitTheBudgetModeIsCertain) {
    const TwoBumpy scene(16);
    Tracker exact(scene.a, scene.b);
    Tracker tracker(scene.a, scene.b);
    const detail::Cells frontA = detail::cellsOfCount(scene.a, 64);
    const detail::Cells frontB = detail::cellsOfCount(scene.b, 64);
    for (int frame = 0; frame < 24; frame += 3) {
        const TwoBumpy::Frame where = scene.at(frame);
        const auto truth = exact.step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::exact));
        const auto result = tracker.step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::budget));
        EXPECT_TRUE(result.certain);
        EXPECT_EQ(result.miss.missed, 0);
        EXPECT_EQ(result.miss.missedBound, 0);
        const auto cells = cellPairs(pairsOf(truth), frontA, scene.a, frontB, scene.b);
        EXPECT_EQ(cellPairs(pairsOf(result), frontA, scene.a, frontB, scene.b), cells);
        EXPECT_EQ(result.miss.reported, cells.size());
        EXPECT_TRUE(std::ranges::includes(pairsOf(truth), pairsOf(result)));
    }
}

TEST(Tracker, KeepsItsBudget) {
    const TwoBumpy scene(16);
    for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
        Tracker tracker(scene.a, scene.b);
        for (const std::uint64_t work : {0U, 1U, 10U, 100U, 500U, 2000U}) {
            const TwoBumpy::Frame where = scene.at(18);
            const TrackResult result =
                tracker.step(where.stateA(), where.stateB(), TwoBumpy::settings(mode), {.work = work});
            EXPECT_LE(result.work, work == 0 ? 0 : work + 40);
            EXPECT_NE(result.stop, StopReason::invalidInput);
            if (work == 0) {
                EXPECT_TRUE(result.contacts.empty());
                EXPECT_FALSE(result.certain);
                EXPECT_EQ(result.stop, StopReason::budget);
            }
        }
    }
}

TEST(Tracker, WithoutABudgetKeepsWhatItKnows) {
    const TwoBumpy scene(16);
    Tracker tracker(scene.a, scene.b);
    const TwoBumpy::Frame where = scene.at(18);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    const TrackResult before = tracker.step(where.stateA(), where.stateB(), settings);
    ASSERT_GT(before.tracked, 10U);
    const TrackResult none = tracker.step(where.stateA(), where.stateB(), settings, {.work = 0});
    EXPECT_EQ(none.carried, before.tracked);
    EXPECT_EQ(none.miss.missedBound, std::numeric_limits<double>::infinity());
    // Sixteen to a unit, those that waited longest first, and no more than its share.
    const TrackResult few = tracker.step(where.stateA(), where.stateB(), settings, {.work = 1});
    EXPECT_EQ(few.contacts.size() + few.carried, before.tracked);
    EXPECT_LE(few.contacts.size(), 16U);
    const TrackResult after = tracker.step(where.stateA(), where.stateB(), settings, {.work = 100});
    EXPECT_EQ(after.carried, 0U);
    EXPECT_GE(after.tracked, before.tracked * 9 / 10);
}

TEST(Tracker, TimeEndsAStepToo) {
    const TwoBumpy scene(16);
    const TwoBumpy::Frame where = scene.at(18);
    for (const TrackMode mode : {TrackMode::exact, TrackMode::resolution, TrackMode::budget}) {
        Tracker tracker(scene.a, scene.b);
        static std::chrono::nanoseconds now;
        now = std::chrono::nanoseconds(0);
        Budget budget;
        budget.time = std::chrono::nanoseconds(5);
        budget.clock = []() noexcept { return now += std::chrono::nanoseconds(1); };
        const TrackResult result = tracker.step(where.stateA(), where.stateB(), TwoBumpy::settings(mode), budget);
        EXPECT_EQ(result.stop, StopReason::budget);
        EXPECT_GT(result.work, 64U);
        EXPECT_LT(result.work, 400U);
    }
}

TEST(Tracker, ContactsThatStayAreKept) {
    const TwoBumpy scene(16);
    Tracker tracker(scene.a, scene.b);
    const TwoBumpy::Frame where = scene.at(18);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    const TrackResult first = tracker.step(where.stateA(), where.stateB(), settings, {.work = 1500});
    const TrackResult second = tracker.step(where.stateA(), where.stateB(), settings, {.work = 1500});
    EXPECT_TRUE(std::ranges::includes(pairsOf(second), pairsOf(first)));
    std::size_t old = 0;
    for (const TrackedContact& contact : second.contacts) {
        EXPECT_LE(contact.age, 1U);
        old += contact.age;
    }
    EXPECT_EQ(old, first.contacts.size());
    tracker.clear();
    EXPECT_EQ(tracker.steps(), 2U);
    EXPECT_EQ(tracker.step(where.stateA(), where.stateB(), settings, {.work = 0}).tracked, 0U);
}

TEST(Tracker, TheNumberOfContactsDependsOnTheSpacingNotOnTheTriangles) {
    std::vector<double> counts;
    for (const int frequency : {32, 64}) {
        const TwoBumpy scene(frequency);
        Tracker tracker(scene.a, scene.b);
        const TwoBumpy::Frame where = scene.at(18);
        TrackSettings settings = TwoBumpy::settings(TrackMode::resolution);
        settings.spacing = 0.15F;
        const TrackResult result = tracker.step(where.stateA(), where.stateB(), settings);
        counts.push_back(static_cast<double>(result.contacts.size()));
    }
    EXPECT_GT(counts[0], 10);
    EXPECT_NEAR(counts[1] / counts[0], 1, 0.5);  // four times as many triangles
}

TEST(Tracker, MoreBudgetFindsMoreOnAverage) {
    const TwoBumpy scene(24);
    const TwoBumpy::Frame where = scene.at(18);
    double found[3] = {};
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        int i = 0;
        for (const std::uint64_t work : {600U, 1200U, 2400U}) {
            Tracker tracker(scene.a, scene.b);
            TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
            settings.seed = seed;
            found[i++] += static_cast<double>(
                tracker.step(where.stateA(), where.stateB(), settings, {.work = work}).contacts.size());
        }
    }
    EXPECT_GT(found[1], found[0]);
    EXPECT_GT(found[2], found[1]);
}

TEST(Tracker, FollowsWhatComesNear) {
    const TwoBumpy scene(16);
    TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    settings.followDistance = 0.1F;
    settings.maxDistance = 0.001F;
    Tracker tracker(scene.a, scene.b);
    std::uint32_t nearAtMost = 0;
    for (int frame = 0; frame < 20; ++frame) {
        const TwoBumpy::Frame where = scene.at(frame);
        const TrackResult result = tracker.step(where.stateA(), where.stateB(), settings, {.work = 2000});
        nearAtMost = std::max(nearAtMost, result.tracked - static_cast<std::uint32_t>(result.contacts.size()));
    }
    EXPECT_GT(nearAtMost, 5U);
}

}  // namespace
}  // namespace grapeshot::test
