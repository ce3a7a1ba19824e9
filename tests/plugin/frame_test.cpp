// When a frame begins and how its dispatches share it; what makes a pair important. Without a world.
#include <grapeshot/plugin/detail/frame.hpp>
#include <grapeshot/plugin/detail/pair_importance.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace grapeshot {
namespace {

using detail::Frame;
using detail::importanceOf;
using detail::PairTraits;

constexpr int caches[4] = {};
const void* const world = &caches[0];
const void* const ghost = &caches[1];
const void* const otherGhost = &caches[2];

TEST(Frame, BeginsWithEachDispatchOfTheWorldsCache) {
    Frame frame;
    const Budget budget{.work = 100};
    for (std::uint64_t step = 1; step <= 3; ++step) {
        EXPECT_TRUE(frame.enterDispatch(world, budget));
        for (int i = 0; i < 5; ++i) {  // a controller on its way out of a wall
            EXPECT_FALSE(frame.enterDispatch(ghost, budget));
        }
        EXPECT_FALSE(frame.enterDispatch(otherGhost, budget));
        EXPECT_EQ(frame.number(), step);
        EXPECT_EQ(frame.dispatches(), 7);
    }
}

TEST(Frame, AnotherWorldsCacheTakesOverWhenTheFirstIsGone) {
    Frame frame;
    frame.enterDispatch(world, {});
    int began = 0;
    for (int i = 0; i < 40; ++i) {
        began += frame.enterDispatch(ghost, {}) ? 1 : 0;
    }
    EXPECT_EQ(began, 24);
    EXPECT_FALSE(frame.enterDispatch(world, {}));
}

TEST(Frame, AnotherWorldTakesOverWithItsGhostsToo) {
    Frame frame;
    frame.enterDispatch(world, {});
    int began = 0;
    for (int i = 0; i < 20; ++i) {
        began += frame.enterDispatch(ghost, {}) ? 1 : 0;
        began += frame.enterDispatch(otherGhost, {}) ? 1 : 0;
    }
    EXPECT_EQ(began, 12);  // from the seventeenth on, with each dispatch of the one that took over
}

TEST(Frame, OnceToldItBeginsOnlyWhenTold) {
    Frame frame;
    frame.enterDispatch(world, {.work = 100});
    frame.begin(4, {.work = 400});
    EXPECT_EQ(frame.number(), 2U);
    std::uint64_t given = 0;
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(frame.enterDispatch(world, {.work = 400}));
        const std::uint64_t share = frame.dispatchShare();
        EXPECT_EQ(share, i == 1 ? 120U : i == 0 ? 100U : i == 2 ? 130U : 200U) << i;
        const std::uint64_t spent = i == 0 ? 40 : i == 1 ? 100 : 60;
        frame.payDispatch(spent, 8);
        given += spent;
    }
    EXPECT_EQ(frame.number(), 2U);
    EXPECT_EQ(frame.spent(), given);
    EXPECT_EQ(frame.mandatory(), 32U);
}

TEST(Frame, KeepsSomethingForThoseThatCameLateLastTime) {
    Frame frame;
    const Budget budget{.work = 1000};
    frame.enterDispatch(world, budget);
    EXPECT_EQ(frame.dispatchShare(), 1000U);
    frame.payDispatch(900, 80);
    EXPECT_EQ(frame.latecomerSlice(8).work, 100U);
    frame.payLatecomer(100, 8);
    EXPECT_EQ(frame.latecomerSlice(8).work, 8U) << "never less than its mandatory slice";
    frame.payLatecomer(8, 8);
    frame.enterDispatch(ghost, budget);
    EXPECT_EQ(frame.dispatchShare(), 0U);
    frame.payDispatch(400, 24);
    frame.enterDispatch(world, budget);
    EXPECT_EQ(frame.dispatchShare(), 750U) << "a quarter of it at most";
    frame.payDispatch(750, 80);
    EXPECT_EQ(frame.latecomerSlice(8).work, 125U) << "one of two";
    frame.payLatecomer(10, 8);
    EXPECT_EQ(frame.latecomerSlice(8).work, 240U) << "the last, as far as is known";
    frame.enterDispatch(world, {.work = 40});
    EXPECT_EQ(frame.dispatchShare(), 30U);
    frame.enterDispatch(world, {});
    EXPECT_EQ(frame.dispatchShare(), unlimited);
    EXPECT_EQ(frame.latecomerSlice(8).work, unlimited);
    EXPECT_FALSE(frame.isLimited());
}

TEST(Frame, MandatorySlicesToComeAreKeptWhole) {
    Frame frame;
    for (int step = 0; step < 3; ++step) {
        frame.enterDispatch(world, {.work = 100});
        const std::uint64_t share = frame.dispatchShare();
        EXPECT_EQ(share, step == 0 ? 100U : 40U);
        frame.payDispatch(share, 16);
        frame.enterDispatch(ghost, {.work = 100});
        frame.payDispatch(60, 60);
    }
}

std::chrono::nanoseconds injected{0};

TEST(Frame, TimeIsThatOfTheGivenClock) {
    Budget budget;
    budget.time = std::chrono::microseconds(10);
    budget.clock = []() noexcept { return injected; };
    Frame frame;
    frame.enterDispatch(world, budget);
    EXPECT_TRUE(frame.isLimited());
    EXPECT_EQ(frame.timeLeft(), std::chrono::microseconds(10));
    EXPECT_EQ(frame.latecomerSlice(8).time, std::chrono::microseconds(10));
    injected += std::chrono::microseconds(7);
    EXPECT_EQ(frame.timeLeft(), std::chrono::microseconds(3));
    injected += std::chrono::microseconds(7);
    EXPECT_EQ(frame.timeLeft(), std::chrono::nanoseconds(0));
    EXPECT_EQ(frame.latecomerSlice(8).time, never);
    EXPECT_EQ(frame.latecomerSlice(8).work, 8U);
    frame.enterDispatch(world, budget);
    EXPECT_EQ(frame.timeLeft(), std::chrono::microseconds(10));
}

TEST(PairImportance, RisesWithEverythingThatMatters) {
    PairTraits plain;
    plain.mass = plain.size = 1;
    plain.uncertain = false;
    std::array<PairTraits, 7> pairs;
    pairs.fill(plain);
    pairs[1].motion = 3;
    pairs[2].mass = 5;
    pairs[3].size = 2;
    pairs[4].staleness = 30;
    pairs[5].uncertain = true;
    pairs[6].weight = 10;
    std::array<float, 7> importance{};
    importanceOf(pairs, importance);
    for (std::size_t i = 1; i < pairs.size(); ++i) {
        EXPECT_GT(importance[i], 1.5F * importance[0]) << i;
    }
    EXPECT_FLOAT_EQ(importance[6], 10 * importance[0]);
}

TEST(PairImportance, IsFiniteWhateverComes) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    std::array<PairTraits, 8> pairs;
    pairs[0] = {nan, nan, nan, 0, true, nan};
    pairs[1] = {infinity, infinity, infinity, 0xffffffffU, true, infinity};
    pairs[2] = {-1, -1, -1, 0, false, -1};
    pairs[3] = {0, 0, 0, 0, false, 0};
    pairs[4] = {1, 1e30F, 1e-30F, 5, false, 1};
    pairs[5] = {1, 1, 1, 60, true, std::numeric_limits<float>::max()};
    pairs[6] = {0, 1, 1, 0, false, std::numeric_limits<float>::denorm_min()};
    std::array<float, 8> importance{};
    importanceOf(pairs, importance);
    for (const float value : importance) {
        EXPECT_TRUE(std::isfinite(value) && value > 0) << value;
    }
}

}  // namespace
}  // namespace grapeshot
