#include <grapeshot/narrowphase/schedule.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <grapeshot/core/random.hpp>

namespace grapeshot {
namespace {

using Slices = std::vector<std::uint64_t>;

Slices slicesOf(const std::vector<ScheduledPair>& pairs, std::uint64_t budget, ScheduleSums* sums = nullptr) {
    Slices slices(pairs.size(), 12345);
    const ScheduleSums found = schedule(pairs, budget, slices);
    if (sums != nullptr) {
        *sums = found;
    }
    return slices;
}

std::uint64_t sum(const Slices& slices) {
    return std::accumulate(slices.begin(), slices.end(), std::uint64_t{0});
}

/// Pairs of all kinds: from very to hardly important, modest and insatiable, young and old.
std::vector<ScheduledPair> mixed(std::size_t count, std::uint64_t seed) {
    std::vector<ScheduledPair> pairs;
    for (std::size_t i = 0; i < count; ++i) {
        const auto draw = [&](std::uint32_t which) { return randomUnit({seed, i, 0}, which); };
        ScheduledPair pair;
        pair.key = 1000 - 7 * i;
        pair.importance = draw(0) < 0.1F ? 1.0F : std::exp2(20 * draw(1) - 10);
        pair.age = draw(2) < 0.5F ? 0 : static_cast<std::uint32_t>(100 * draw(3));
        pair.mandatory = draw(4) < 0.8F ? mandatorySlice : static_cast<std::uint64_t>(40 * draw(5));
        pair.wanted = draw(6) < 0.3F ? unlimited : static_cast<std::uint64_t>(300 * draw(7));
        pairs.push_back(pair);
    }
    return pairs;
}

/// One portion after the other to whom its turn is: what `schedule` has to give, slowly.
Slices dealtOneByOne(const std::vector<ScheduledPair>& pairs, std::uint64_t budget) {
    Slices slices;
    std::vector<std::uint64_t> most, dealt(pairs.size(), 0);
    for (const ScheduledPair& pair : pairs) {
        slices.push_back(pair.mandatory);
        const std::uint64_t wanted = std::max(pair.wanted, pair.mandatory) - pair.mandatory;
        most.push_back(wanted / slicePortion + (wanted % slicePortion != 0 ? 1 : 0));
    }
    std::uint64_t rest = budget - std::min(budget, sum(slices));
    while (rest > 0) {
        std::size_t turn = pairs.size();
        double best = -1;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const double weight = double{pairs[i].importance} * (1.0 + pairs[i].age);
            const double quotient = weight / static_cast<double>(dealt[i] + 1);
            const bool first = turn == pairs.size() || quotient > best ||
                               (quotient == best && (dealt[i] < dealt[turn] ||
                                                     (dealt[i] == dealt[turn] && pairs[i].key < pairs[turn].key)));
            if (dealt[i] < most[i] && first) {
                turn = i;
                best = quotient;
            }
        }
        if (turn == pairs.size()) {
            break;
        }
        ++dealt[turn];
        const std::uint64_t portion = std::min(rest, slicePortion);
        slices[turn] += portion;
        rest -= portion;
    }
    return slices;
}

TEST(Schedule, IsWhatDealingOneByOneGives) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const std::vector<ScheduledPair> pairs = mixed(17, seed);
        for (const std::uint64_t budget : {0U, 100U, 137U, 400U, 999U, 1600U, 5000U, 60000U}) {
            ASSERT_EQ(slicesOf(pairs, budget), dealtOneByOne(pairs, budget)) << seed << ' ' << budget;
        }
    }
}

TEST(Schedule, EveryPairGetsItsMandatorySliceAndTheSumIsBounded) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const std::vector<ScheduledPair> pairs = mixed(1 + 5 * seed, seed);
        for (std::uint64_t budget = 0; budget < 40000; budget = 2 * budget + 3) {
            ScheduleSums sums;
            const Slices slices = slicesOf(pairs, budget, &sums);
            std::uint64_t mandatory = 0;
            std::uint64_t wanted = 0;
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                EXPECT_GE(slices[i], pairs[i].mandatory);
                if (pairs[i].wanted != unlimited) {
                    EXPECT_LT(slices[i], std::max(pairs[i].wanted, pairs[i].mandatory) + slicePortion);
                }
                mandatory += pairs[i].mandatory;
                wanted = wanted > unlimited - pairs[i].wanted ? unlimited : wanted + pairs[i].wanted;
            }
            EXPECT_EQ(sums.mandatory, mandatory);
            EXPECT_EQ(sums.slices, sum(slices));
            EXPECT_LE(sums.slices, std::max(budget, mandatory));
            if (wanted == unlimited) {  // somebody takes whatever there is
                EXPECT_EQ(sums.slices, std::max(budget, mandatory));
            }
        }
    }
}

TEST(Schedule, MoreBudgetNeverGivesAnybodyLess) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<ScheduledPair> pairs = mixed(40, seed);
        Slices before(pairs.size(), 0);
        for (std::uint64_t budget = 0; budget < 9000; budget += 1 + budget % 13) {
            const Slices slices = slicesOf(pairs, budget);
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                ASSERT_GE(slices[i], before[i]) << "seed " << seed << ", budget " << budget;
            }
            before = slices;
        }
    }
}

TEST(Schedule, DoesNotDependOnTheOrder) {
    const std::vector<ScheduledPair> pairs = mixed(60, 3);
    std::vector<ScheduledPair> turned(pairs.rbegin(), pairs.rend());
    std::swap(turned[5], turned[31]);
    for (const std::uint64_t budget : {300U, 1111U, 7000U, 90000U}) {
        const Slices x = slicesOf(pairs, budget);
        const Slices y = slicesOf(turned, budget);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const auto same = std::find_if(turned.begin(), turned.end(),
                                           [&](const ScheduledPair& pair) { return pair.key == pairs[i].key; });
            EXPECT_EQ(x[i], y[static_cast<std::size_t>(same - turned.begin())]);
        }
    }
}

TEST(Schedule, TheMoreImportantAndTheOlderGetMore) {
    std::vector<ScheduledPair> pairs(3);
    for (std::size_t i = 0; i < 3; ++i) {
        pairs[i].key = i;
    }
    pairs[1].importance = 4;
    pairs[2].age = 2;
    const Slices slices = slicesOf(pairs, 3 * mandatorySlice + 800 * slicePortion);
    const auto portions = [&](std::size_t i) { return (slices[i] - mandatorySlice) / slicePortion; };
    EXPECT_EQ(portions(0), 100U);
    EXPECT_EQ(portions(1), 400U);
    EXPECT_EQ(portions(2), 300U);
}

TEST(Schedule, EqualsShareAndTheLowestKeyComesFirst) {
    std::vector<ScheduledPair> pairs(5);
    for (std::size_t i = 0; i < 5; ++i) {
        pairs[i].key = 50 - i;
    }
    const Slices slices = slicesOf(pairs, 5 * mandatorySlice + 7 * slicePortion + 3);
    EXPECT_EQ(slices,
              (Slices{mandatorySlice + slicePortion, mandatorySlice + slicePortion, mandatorySlice + slicePortion + 3,
                      mandatorySlice + 2 * slicePortion, mandatorySlice + 2 * slicePortion}));
}

/// However small its importance, and with room for a single portion in a step. A pair's age counts the steps without
/// one.
TEST(Schedule, NobodyWaitsForEver) {
    constexpr std::size_t count = 12;
    constexpr float least = 0.01F;
    std::vector<ScheduledPair> pairs(count);
    for (std::size_t i = 0; i < count; ++i) {
        pairs[i].key = i;
        pairs[i].importance = i == 0 ? least : 0.2F + 0.8F * randomUnit({5, i, 0}, 0);
    }
    const auto bound = static_cast<std::uint32_t>(count / least);
    std::vector<int> served(count, 0);
    std::uint32_t longest = 0;
    for (int step = 0; step < 20000; ++step) {
        const Slices slices = slicesOf(pairs, count * mandatorySlice + slicePortion);
        for (std::size_t i = 0; i < count; ++i) {
            const bool got = slices[i] > mandatorySlice;
            served[i] += got ? 1 : 0;
            pairs[i].age = got ? 0 : pairs[i].age + 1;
            longest = std::max(longest, pairs[i].age);
        }
    }
    EXPECT_LE(longest, bound);
    EXPECT_GT(longest, 20U) << "nobody had to wait: the test says little";
    EXPECT_GE(served[0], 20000 / static_cast<int>(bound));
    EXPECT_GT(*std::max_element(served.begin(), served.end()), 3 * served[0]);
}

TEST(Schedule, OddBudgetsAndImportancesAreDefined) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    std::vector<ScheduledPair> pairs(5);
    const float importances[] = {1, nan, -3, 0, infinity};
    for (std::size_t i = 0; i < 5; ++i) {
        pairs[i].key = i;
        pairs[i].importance = importances[i];
    }
    EXPECT_EQ(slicesOf(pairs, 0), Slices(5, mandatorySlice));
    const Slices some = slicesOf(pairs, 5 * mandatorySlice + 2000 * slicePortion);
    EXPECT_EQ(some[1], mandatorySlice);
    EXPECT_EQ(some[2], mandatorySlice);
    EXPECT_EQ(some[3], mandatorySlice);
    EXPECT_GT(some[4], some[0]);
    pairs[1].age = pairs[2].age = pairs[3].age = 2000000;  // even so they are served some day
    pairs[4].wanted = mandatorySlice;
    const Slices aged = slicesOf(pairs, 5 * mandatorySlice + 10 * slicePortion);
    EXPECT_GT(aged[1], mandatorySlice);
    EXPECT_EQ(aged[1], aged[2]);

    ScheduleSums sums;
    EXPECT_EQ(slicesOf(pairs, unlimited, &sums), Slices(5, unlimited));
    EXPECT_EQ(sums.slices, unlimited);
    EXPECT_EQ(sums.mandatory, 5 * mandatorySlice);
    const Slices huge = slicesOf(pairs, unlimited - 1, &sums);
    EXPECT_LE(sums.slices, unlimited - 1);
    EXPECT_GT(huge[0], unlimited / 8);
    EXPECT_TRUE(slicesOf({}, 100, &sums).empty());
    EXPECT_EQ(sums.slices, 0U);
}

TEST(Schedule, TenThousandPairsAndABudgetOfAnySize) {
    const std::vector<ScheduledPair> pairs = mixed(10000, 9);
    for (const std::uint64_t budget : {std::uint64_t{200000}, std::uint64_t{1} << 40U, std::uint64_t{1} << 62U}) {
        ScheduleSums sums;
        const Slices slices = slicesOf(pairs, budget, &sums);
        EXPECT_LE(sums.slices, budget);
        EXPECT_GT(sums.slices, budget - budget / 1000);
    }
}

}  // namespace
}  // namespace grapeshot
