// Equations 8 and 9 against enumeration in whole numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <grapeshot/adb/reference/hypergeometric.hpp>
#include <support/poses.hpp>

namespace grapeshot::reference {
namespace {

using test::Random;

/// Of all ways to choose sB of s bins, in how many are at least x of the first sA? Exact.
struct Ways {
    std::uint64_t good = 0;
    std::uint64_t all = 0;
    [[nodiscard]] double share() const { return static_cast<double>(good) / static_cast<double>(all); }
};

Ways enumerate(const Bins& bins, int x) {
    Ways ways;
    const std::uint32_t blue = (1U << static_cast<unsigned>(bins.sA)) - 1;
    for (std::uint32_t red = 0; red < 1U << static_cast<unsigned>(bins.s); ++red) {
        if (std::popcount(red) == bins.sB) {
            ++ways.all;
            ways.good += std::popcount(red & blue) >= x ? 1U : 0U;
        }
    }
    return ways;
}

/// As printed: 1 - sum over t < x of C(sB, t) C(s - sB, sA - t) / C(s, sA), with whole numbers up to the division.
double asPrinted(const Bins& bins, int x) {
    const auto choose = [](int n, int k) -> std::int64_t {
        if (k < 0 || k > n) {
            return 0;
        }
        std::int64_t result = 1;
        for (int i = 1; i <= k; ++i) {
            result = result * (n - k + i) / i;
        }
        return result;
    };
    std::int64_t fewer = 0;
    for (int t = 0; t < x; ++t) {
        fewer += choose(bins.sB, t) * choose(bins.s - bins.sB, bins.sA - t);
    }
    const std::int64_t all = choose(bins.s, bins.sA);
    return static_cast<double>(all - fewer) / static_cast<double>(all);
}

TEST(Hypergeometric, IsTheShareOfAllArrangements) {
    const TailTable table(11);
    for (int s = 1; s <= 11; ++s) {
        for (int sA = 0; sA <= s; ++sA) {
            for (int sB = 0; sB <= s; ++sB) {
                const Tails tails = table(Bins{s, sA, sB});
                for (int x = 0; x <= s + 1; ++x) {
                    const double truth = enumerate({s, sA, sB}, x).share();
                    EXPECT_NEAR(atLeast({s, sA, sB}, x), truth, 1e-13) << s << ' ' << sA << ' ' << sB << ' ' << x;
                    EXPECT_NEAR(asPrinted({s, sA, sB}, x), truth, 1e-15);
                    if (x >= 1 && x <= tableLength) {
                        EXPECT_NEAR(tails[static_cast<std::size_t>(x - 1)], truth, 1e-7);
                    }
                }
            }
        }
    }
}

TEST(Hypergeometric, IsThePrintedFormulaForFiftyBins) {
    for (const Bins bins : {Bins{50, 10, 12}, Bins{50, 30, 35}, Bins{40, 5, 40}, Bins{48, 24, 24}}) {
        for (int x = 0; x <= std::min(bins.sA, bins.sB); ++x) {
            EXPECT_NEAR(atLeast(bins, x), asPrinted(bins, x), 1e-12);
        }
    }
}

TEST(Hypergeometric, KnowsThePigeonhole) {
    const double expected[] = {1, 1, 1, 5.0 / 7, 1.0 / 7, 0};
    for (int x = 0; x <= 5; ++x) {
        EXPECT_NEAR(atLeast({7, 4, 5}, x), expected[x], 1e-14);
    }
}

TEST(Hypergeometric, HasNoCollisionCellWithoutFilledCells) {
    for (const Bins bins : {Bins{20, 0, 9}, Bins{20, 9, 0}, Bins{20, 0, 0}}) {
        EXPECT_EQ(atLeast(bins, 1), 0);
        EXPECT_EQ(tailTable()(bins)[0], 0);
        EXPECT_EQ(atLeast(bins, 0), 1);
    }
    EXPECT_EQ(atLeast({20, 4, 6}, 5), 0);
}

TEST(Hypergeometric, ClampsWhatIsOutOfRange) {
    EXPECT_EQ(atLeast({5, 9, 3}, 3), 1);
    EXPECT_EQ(atLeast({5, -2, 3}, 1), 0);
    EXPECT_EQ(atLeast({0, 1, 1}, 1), 1);
    EXPECT_EQ(tailTable()(Bins{5, 9, 3}), tailTable()(Bins{5, 5, 3}));
    EXPECT_EQ(tailTable()(0.0, 7.5, 7.5)[0], 1);
    EXPECT_EQ(tailTable()(3.0, -1.0, 2.0)[0], 0);
}

TEST(Hypergeometric, KeepsTinyTails) {
    // Known to 50 digits by rational arithmetic; 1 minus a sum gives 0 in single and noise in double precision.
    EXPECT_NEAR(atLeast({512, 64, 64}, 25) / 3.3e-9, 1, 0.02);
    EXPECT_NEAR(atLeast({4096, 500, 400}, 90) / 7.7e-10, 1, 0.02);
    EXPECT_NEAR(atLeast({60, 30, 30}, 30) / std::exp(-(std::lgamma(61) - 2 * std::lgamma(31))), 1, 1e-10);
}

TEST(Hypergeometric, InterpolatesBetweenWholeNumbers) {
    const TailTable& table = tailTable();
    // One bin, filled with probabilities a and b: a collision cell with probability a b.
    EXPECT_NEAR(table(1.0, 0.25, 0.5)[0], 0.125, 1e-7);
    EXPECT_GT(table(40.0, 0.01, 3.0)[0], 0) << "rounding to 0 would prune";
    const Tails low = table(Bins{30, 7, 9});
    const Tails high = table(Bins{30, 8, 9});
    const Tails between = table(30.2, 7.25, 9.0);
    for (std::size_t x = 0; x < low.size(); ++x) {
        EXPECT_NEAR(between[x], 0.75F * low[x] + 0.25F * high[x], 1e-6);
    }
    EXPECT_EQ(table(30.0, 7.0, 9.0), low);
}

TEST(Hypergeometric, TableGoesOnWhereItEnds) {
    const TailTable small(8);
    for (const Bins bins : {Bins{8, 3, 5}, Bins{9, 3, 5}, Bins{64, 20, 11}, Bins{500, 60, 90}}) {
        const Tails tails = small(bins);
        for (int x = 1; x <= tableLength; ++x) {
            EXPECT_NEAR(tails[static_cast<std::size_t>(x - 1)], atLeast(bins, x), 1e-7);
        }
        EXPECT_EQ(tails, small(Bins{bins.s, bins.sB, bins.sA})) << "symmetric in the colours";
    }
}

TEST(Probability, GrowsWithFilledCellsAndWithTheBound) {
    Random random(3);
    const TailTable& table = tailTable();
    for (int i = 0; i < 5000; ++i) {
        const double s = random.uniform(1, 60);
        const double sA = random.uniform(0, s);
        const double sB = random.uniform(0, s);
        const double bound = random.uniform(0, 1);
        const double p = collisionProbability(table(s, sA, sB), bound, 10);
        EXPECT_GE(p, 0);
        EXPECT_LE(p, 1 + 1e-6);
        EXPECT_GE(collisionProbability(table(s, sA + 1, sB), bound, 10), p - 1e-6);
        EXPECT_GE(collisionProbability(table(s, sA, sB + 1), bound, 10), p - 1e-6);
        EXPECT_GE(collisionProbability(table(s, sA, sB), std::min(1.0, bound + 0.1), 10), p - 1e-6);
        EXPECT_GE(p, collisionProbability(table(s, sA, sB), bound, 3)) << "more x, larger maximum";
    }
}

// Eq. 9 is Markov's inequality for 1 - (1 - LB)^c.
TEST(Probability, IsNotAboveTheExpectation) {
    Random random(4);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
        const int s = 1 + static_cast<int>(random.uniform(0, 300));
        const Bins bins{s, static_cast<int>(random.uniform(0, s + 1)), static_cast<int>(random.uniform(0, s + 1))};
        const double bound = random.unit();
        const double expected = expectedCollision(bins, bound);
        const double p = collisionProbability(tailTable()(bins), bound, 10);
        EXPECT_LE(p, expected + 1e-6);
        worst = std::max(worst, expected - p);
    }
    EXPECT_GT(worst, 0.3) << "with x <= 10 it is far from tight for many cells and a small bound";
}

TEST(Probability, OfExpectationIsTheAlternatingSeries) {
    // E[1 - (1 - L)^c] = 1 - sum over k of (-L)^k C(sA, k) C(sB, k) / C(s, k)
    const Bins bins{20, 6, 8};
    const double bound = 0.3;
    double sum = 0;
    double term = 1;
    for (int k = 0; k <= 6; ++k) {
        sum += term;
        term *= -bound * (bins.sA - k) * (bins.sB - k) / ((k + 1.0) * (bins.s - k));
    }
    EXPECT_NEAR(expectedCollision(bins, bound), 1 - sum, 1e-12);
}

// 1 - (1 - LB)^10 must reach pMin: nothing above 37 % of the summed depth can be evidence at 0.99.
TEST(Probability, CannotReachPMinWithASmallBound) {
    const Tails full = tailTable()(Bins{64, 64, 64});
    EXPECT_LT(collisionProbability(full, 0.365, 10), 0.99);
    EXPECT_GT(collisionProbability(full, 0.375, 10), 0.99);
}

}  // namespace
}  // namespace grapeshot::reference
