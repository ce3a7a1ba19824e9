// Is what a step says of its misses true, over many draws?
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

TEST(MissEstimate, FollowsItsCounts) {
    MissEstimate miss;
    estimateMissed(miss, false);
    EXPECT_TRUE(std::isnan(miss.missed));
    EXPECT_EQ(miss.missedBound, std::numeric_limits<double>::infinity());
    miss.candidates = 1100;
    miss.reported = 100;
    miss.unknown = 1000;
    estimateMissed(miss, true);
    EXPECT_TRUE(std::isnan(miss.missed));
    EXPECT_EQ(miss.missedBound, 1000);
    miss.sampled = 100;
    estimateMissed(miss, true);
    EXPECT_EQ(miss.missed, 0);
    EXPECT_NEAR(miss.missedBound, 29, 1);  // a little below the rule of three
    miss.hits = 5;
    estimateMissed(miss, true);
    EXPECT_EQ(miss.missed, 45);
    EXPECT_GT(miss.missedBound, 70);
    const double finished = miss.missedBound;
    miss.sampled = 102;
    miss.open = 2;  // as bad as hits
    estimateMissed(miss, true);
    EXPECT_EQ(miss.missed, 45);
    EXPECT_GT(miss.missedBound, finished + 10);
    miss.sampled = 1000;
    miss.open = 0;
    estimateMissed(miss, true);
    EXPECT_EQ(miss.missed, 0);
    EXPECT_EQ(miss.missedBound, 0);
}

TEST(MissEstimate, UnseenIsGoodAndTurings) {
    MissEstimate miss;
    estimateUnseen(miss, 0, 0);
    EXPECT_TRUE(std::isnan(miss.unseen));
    estimateUnseen(miss, 8, 200);
    EXPECT_DOUBLE_EQ(miss.unseen, 0.04);
    EXPECT_DOUBLE_EQ(miss.unseenBound, (8 + 2 * 3 + 1) / 200.0);
    estimateUnseen(miss, 5, 5);
    EXPECT_EQ(miss.unseenBound, 1);
}

/// Draws with many seeds, of scenes that stand still: an estimate without bias, a bound that holds.
TEST(MissEstimate, HoldsOnTrackedScenes) {
    const TwoBumpy scene(20);
    TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    settings.maxDives = 4;
    settings.auditShare = 0.6F;
    const detail::Cells frontA = detail::cellsOfCount(scene.a, settings.frontCells);
    const detail::Cells frontB = detail::cellsOfCount(scene.b, settings.frontCells);
    const std::size_t seeds = sampleSize(150, 2000);
    double estimates = 0;
    double truths = 0;
    double squares = 0;
    std::size_t steps = 0;
    std::size_t below = 0;
    std::size_t open = 0;
    for (const int frame : {13, 16, 20}) {
        const TwoBumpy::Frame where = scene.at(frame);
        const TrackResult all =
            Tracker(scene.a, scene.b).step(where.stateA(), where.stateB(), TwoBumpy::settings(TrackMode::exact));
        std::set<std::pair<std::uint32_t, std::uint32_t>> contactCells;
        for (const TrackedContact& contact : all.contacts) {
            contactCells.emplace(frontA.cellOf(scene.a, contact.pair.triangleA),
                                 frontB.cellOf(scene.b, contact.pair.triangleB));
        }
        ASSERT_GT(contactCells.size(), 4U);
        for (std::size_t seed = 1; seed <= seeds; ++seed) {
            settings.seed = seed;
            const TrackResult result =
                Tracker(scene.a, scene.b).step(where.stateA(), where.stateB(), settings, {.work = 900});
            ASSERT_TRUE(std::isfinite(result.miss.missedBound));
            ASSERT_LE(result.miss.reported, contactCells.size());
            const double missed = static_cast<double>(contactCells.size() - result.miss.reported);
            estimates += result.miss.missed;
            truths += missed;
            squares += (result.miss.missed - missed) * (result.miss.missed - missed);
            below += result.miss.missedBound < missed ? 1 : 0;
            open += result.miss.open;
            EXPECT_EQ(result.certain, result.miss.missedBound == 0);
            if (result.certain) {
                EXPECT_EQ(missed, 0);
            }
            ++steps;
        }
    }
    const auto n = static_cast<double>(steps);
    EXPECT_GT(truths / n, 1);  // there is something to miss
    EXPECT_LE(static_cast<double>(below), 0.05 * n + 3 * std::sqrt(0.05 * 0.95 * n));
    EXPECT_NEAR(estimates / n, truths / n, 4 * std::sqrt(squares / n) / std::sqrt(n));
    EXPECT_LT(static_cast<double>(open), 0.02 * n);
}

}  // namespace
}  // namespace grapeshot::test
