// Bounds on rates against sums of the binomial distribution itself.
#include <gtest/gtest.h>

#include <cmath>

#include <grapeshot/adb/detail/incomplete_beta.hpp>
#include <grapeshot/adb/rate_bound.hpp>

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

}  // namespace
}  // namespace grapeshot::test
