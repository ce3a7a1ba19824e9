// Bounds on rates against sums of the binomial distribution itself.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <grapeshot/core/detail/incomplete_beta.hpp>
#include <grapeshot/core/rate_bound.hpp>

#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

/// P(count or fewer of trials), term by term from the ratio of neighbours. No gamma function.
double binomialTail(std::uint64_t count, std::uint64_t trials, double rate) {
    auto term = static_cast<long double>(0);  // logarithm
    term = static_cast<long double>(trials) * log1pl(-static_cast<long double>(rate));
    long double sum = expl(term);
    for (std::uint64_t i = 1; i <= count; ++i) {
        term += logl(static_cast<long double>(trials - i + 1) / static_cast<long double>(i)) +
                logl(static_cast<long double>(rate)) - log1pl(-static_cast<long double>(rate));
        sum += expl(term);
    }
    return static_cast<double>(sum);
}

TEST(IncompleteBeta, IsTheBinomialTail) {
    for (const std::uint64_t trials : {1U, 2U, 7U, 40U, 300U, 5000U}) {
        for (const double rate : {1e-6, 0.003, 0.05, 0.5, 0.93, 0.9999}) {
            for (std::uint64_t count = 0; count < trials; count += 1 + trials / 9) {
                const double tail = binomialTail(count, trials, rate);
                const auto a = static_cast<double>(count) + 1;
                const auto b = static_cast<double>(trials - count);
                const double above = std::exp(detail::logIncompleteBetaAbove(rate, a, b));
                const double below = std::exp(detail::logIncompleteBeta(rate, a, b));
                EXPECT_NEAR(above, tail, 1e-11 * (1 + trials) * tail + 1e-300)
                    << count << " of " << trials << " at " << rate;
                EXPECT_NEAR(above + below, 1, 1e-11);
            }
        }
    }
}

TEST(IncompleteBeta, KnowsClosedForms) {
    EXPECT_NEAR(detail::logBeta(1, 1), 0, 1e-14);
    EXPECT_NEAR(detail::logBeta(0.5, 0.5), std::log(3.14159265358979323846), 1e-13);
    EXPECT_NEAR(detail::logBeta(3, 4), std::log(1.0 / 60), 1e-13);
    for (const double x : {1e-9, 0.01, 0.2, 0.5, 0.8, 0.999}) {
        const double arcsine = 2 / 3.14159265358979323846 * std::asin(std::sqrt(x));
        EXPECT_NEAR(detail::logIncompleteBeta(x, 0.5, 0.5), std::log(arcsine), 1e-12);
        EXPECT_NEAR(detail::logIncompleteBeta(x, 7, 1), 7 * std::log(x), 1e-12);
    }
    EXPECT_EQ(detail::logIncompleteBeta(0, 2, 3), -INFINITY);
    EXPECT_EQ(detail::logIncompleteBeta(1, 2, 3), 0);
    // Far out in the tail, where the value itself is no number any more.
    EXPECT_NEAR(detail::logIncompleteBeta(1e-4, 1000, 1), 1000 * std::log(1e-4), 1e-8);
}

TEST(RateBound, HasTheKnownValues) {
    EXPECT_NEAR(upperRate(10, 1000, 0.95), 0.0169, 5e-5);
    EXPECT_NEAR(upperRate(0, 1000, 0.95), 0.0030, 5e-5);
    EXPECT_NEAR(upperRate(50, 5000, 0.95), 0.0126, 5e-5);
    EXPECT_NEAR(upperRate(200, 20'000, 0.95), 0.0112, 5e-5);
    EXPECT_EQ(fewestTrials(0.01, 0.95), 299U);
    EXPECT_EQ(fewestTrials(0.05, 0.95), 59U);
    EXPECT_EQ(fewestTrials(0.001, 0.99), 4603U);
    EXPECT_LE(upperRate(0, 299, 0.95), 0.01);
    EXPECT_GT(upperRate(0, 298, 0.95), 0.01);
}

TEST(RateBound, InvertsTheBinomialTail) {
    for (const double confidence : {0.5, 0.95, 0.975, 0.999}) {
        for (const std::uint64_t trials : {1U, 10U, 333U, 4000U}) {
            for (std::uint64_t count = 0; count < trials; count += 1 + trials / 7) {
                const double upper = upperRate(count, trials, confidence);
                EXPECT_NEAR(binomialTail(count, trials, upper), 1 - confidence, 1e-9);
                EXPECT_DOUBLE_EQ(lowerRate(trials - count, trials, confidence), 1 - upper);
            }
        }
    }
}

TEST(RateBound, KnowsItsEnds) {
    EXPECT_EQ(upperRate(0, 0, 0.95), 1);
    EXPECT_EQ(lowerRate(0, 0, 0.95), 0);
    EXPECT_EQ(upperRate(5, 5, 0.95), 1);
    EXPECT_EQ(lowerRate(0, 5, 0.95), 0);
    EXPECT_GT(lowerRate(5, 5, 0.95), 0.5);
}

TEST(CountBound, InvertsTheHypergeometricTail) {
    // C(n, k) by Pascal's rule, exact in a double for these sizes.
    const auto choose = [](std::uint64_t n, std::uint64_t k) {
        std::vector<double> row(k + 1, 0);
        row[0] = 1;
        for (std::uint64_t i = 0; i < n; ++i) {
            for (std::uint64_t j = k; j > 0; --j) {
                row[j] += row[j - 1];
            }
        }
        return row[k];
    };
    for (const std::uint64_t population : {1U, 2U, 9U, 30U, 50U}) {
        for (std::uint64_t sample = 1; sample <= population; sample += 1 + population / 7) {
            for (std::uint64_t hits = 0; hits <= sample; hits += 1 + sample / 5) {
                const std::uint64_t upper = upperCount(hits, sample, population, 0.95);
                const auto tail = [&](std::uint64_t total) {
                    double sum = 0;
                    for (std::uint64_t i = 0; i <= hits; ++i) {
                        if (i <= total && sample - i <= population - total) {
                            sum += choose(total, i) * choose(population - total, sample - i);
                        }
                    }
                    return sum / choose(population, sample);
                };
                EXPECT_GT(tail(upper), 0.05) << hits << " of " << sample << " of " << population;
                if (upper < population - (sample - hits)) {
                    EXPECT_LE(tail(upper + 1), 0.05) << hits << " of " << sample << " of " << population;
                }
            }
        }
    }
}

TEST(CountBound, KnowsItsEnds) {
    EXPECT_EQ(upperCount(0, 0, 0, 0.95), 0U);
    EXPECT_EQ(upperCount(0, 0, 1000, 0.95), 1000U);
    EXPECT_EQ(upperCount(7, 1000, 1000, 0.95), 7U);
    EXPECT_EQ(upperCount(0, 1000, 1000, 0.95), 0U);
    EXPECT_EQ(upperCount(5, 5, 30, 0.95), 30U);
    // The rule of three, and what a binomial sample would say, which knows no population.
    EXPECT_NEAR(static_cast<double>(upperCount(0, 1000, 1'000'000, 0.95)), 3000, 30);
    EXPECT_NEAR(static_cast<double>(upperCount(10, 1000, 2'000'000, 0.95)), 2e6 * upperRate(10, 1000, 0.95), 200);
}

TEST(CountBound, HoldsForEverySizeOfTheTruth) {
    // By the distribution itself: the probability of a sample whose bound is below the truth is at most 5 %.
    constexpr std::uint64_t population = 40;
    constexpr std::uint64_t sample = 12;
    for (std::uint64_t truth = 0; truth <= population; ++truth) {
        Random random(truth + 1);
        int below = 0;
        int belowDrawn = 0;
        constexpr int draws = 4000;
        for (int draw = 0; draw < draws; ++draw) {
            std::uint64_t hits = 0;
            std::uint64_t left = truth;
            for (std::uint64_t i = 0; i < sample; ++i) {
                if (random.unit() * static_cast<double>(population - i) < static_cast<double>(left)) {
                    ++hits;
                    --left;
                }
            }
            const std::uint64_t upper = upperCount(hits, sample, population, 0.95);
            const std::uint64_t drawn = upperCount(hits, sample, population, 0.95, random.unit());
            EXPECT_LE(drawn, upper);
            below += upper < truth ? 1 : 0;
            belowDrawn += drawn < truth ? 1 : 0;
        }
        const double error = 4 * std::sqrt(0.05 * 0.95 * draws);
        EXPECT_LE(below, 0.05 * draws + error) << truth;
        if (truth > 0) {  // in just so many
            EXPECT_NEAR(belowDrawn, 0.05 * draws, error) << truth;
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
