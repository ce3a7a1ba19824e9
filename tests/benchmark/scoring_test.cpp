#include "scoring.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace grapeshot::bench {
namespace {

/// `count` forecasts of a probability, the given number of them colliding.
void add(std::vector<Forecast>& forecasts, double probability, int count, int colliding) {
    for (int i = 0; i < count; ++i) {
        forecasts.push_back({probability, i < colliding});
    }
}

TEST(Scoring, TrueProbabilitiesHaveNoCalibrationError) {
    std::vector<Forecast> forecasts;
    add(forecasts, 0, 100, 0);
    add(forecasts, 0.21, 100, 21);
    add(forecasts, 0.73, 100, 73);
    add(forecasts, 1, 100, 100);
    const Score result = score(forecasts);
    EXPECT_NEAR(result.ece, 0, 1e-12);
    EXPECT_NEAR(result.eceInDoubt, 0, 1e-12);
    EXPECT_EQ(result.inDoubt, 200U);
    EXPECT_EQ(result.falseNegatives, 21);
    EXPECT_EQ(result.falsePositives, 27);
    EXPECT_DOUBLE_EQ(result.errorPercent, 12);
    EXPECT_NEAR(result.brier, (0.21 * 0.79 + 0.73 * 0.27) / 4, 1e-12);
}

TEST(Scoring, CalibrationErrorIsTheMeanGapOfTheBins) {
    std::vector<Forecast> forecasts;
    add(forecasts, 0.3, 300, 120);  // 0.1 too low
    add(forecasts, 0.8, 100, 60);   // 0.2 too high
    const Score result = score(forecasts);
    EXPECT_NEAR(result.ece, 0.75 * 0.1 + 0.25 * 0.2, 1e-12);
    EXPECT_NEAR(result.eceEqualCount, result.ece, 1e-12);
    EXPECT_EQ(binsOfEqualWidth(forecasts, 20).size(), 2U);
}

TEST(Scoring, BinsOfEqualCountPartNoTies) {
    std::vector<Forecast> forecasts;
    for (int i = 0; i < 90; ++i) {
        add(forecasts, i / 100.0, 1, 0);
    }
    add(forecasts, 0.95, 60, 60);
    const std::vector<Bin> bins = binsOfEqualCount(forecasts, 15);
    ASSERT_EQ(bins.size(), 10U);
    EXPECT_EQ(bins.front().count, 10U);
    EXPECT_EQ(bins.back().count, 60U);
    EXPECT_DOUBLE_EQ(bins.back().share, 1);
}

TEST(Scoring, AreaUnderTheCurveCountsPairsInTheRightOrder) {
    EXPECT_DOUBLE_EQ(score({{0.1, false}, {0.4, false}, {0.6, true}, {0.9, true}}).auc, 1);
    EXPECT_DOUBLE_EQ(score({{0.1, true}, {0.4, false}, {0.6, true}, {0.9, false}}).auc, 0.25);
    EXPECT_DOUBLE_EQ(score({{0.5, true}, {0.5, false}, {0.5, false}}).auc, 0.5);
    EXPECT_TRUE(std::isnan(score({{0.5, true}}).auc));
}

}  // namespace
}  // namespace grapeshot::bench
