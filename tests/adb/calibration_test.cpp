// The table from rates to probabilities, and its text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot::test {
namespace {

using testing::HasSubstr;

TEST(Calibration, ProbabilitiesRiseWithTheRate) {
    const Calibration& calibration = defaultCalibration();
    for (const std::uint64_t steps : {1U, 2U, 3U, 7U, 12U, 30U, 50U, 64U, 65U, 1000U}) {
        float before = 0;
        float beforeAfterwards = 0;
        for (double octaves = -14; octaves <= 14; octaves += 0.1) {
            const auto rate = static_cast<float>(std::exp2(octaves));
            const float p = probabilityAfter(calibration, rate, steps);
            const float afterwards = probabilityAfterwards(calibration, rate, steps);
            EXPECT_TRUE(p >= before && p <= 1) << steps << " " << octaves;
            EXPECT_TRUE(afterwards >= beforeAfterwards && afterwards <= 1);
            before = p;
            beforeAfterwards = afterwards;
        }
        EXPECT_LT(probabilityAfter(calibration, 1e-4F, steps), 0.01F);
    }
    EXPECT_GT(probabilityAfter(calibration, 200, 1), 0.99F);
}

TEST(Calibration, RowsAndKnotsAreWhereTheyShouldBe) {
    Calibration calibration;
    for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
        for (std::size_t knot = 0; knot < Calibration::knots; ++knot) {
            calibration.bySteps[row][knot] = 0.03F * static_cast<float>(row) + 0.005F * static_cast<float>(knot);
        }
    }
    // The first and the last of each row.
    constexpr std::uint64_t steps[][2] = {{1, 1},   {2, 2},   {3, 3},   {4, 4},   {5, 5},   {6, 6},   {7, 7},
                                          {8, 8},   {9, 9},   {10, 10}, {11, 11}, {12, 12}, {13, 13}, {14, 14},
                                          {15, 15}, {16, 16}, {17, 24}, {25, 32}, {33, 48}, {49, 64}, {65, 100'000}};
    static_assert(std::size(steps) == Calibration::stepRows);
    for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
        for (const std::uint64_t step : steps[row]) {
            EXPECT_EQ(Calibration::rowOf(step), row);
            EXPECT_NEAR(probabilityAfter(calibration, 1, step), 0.03 * static_cast<double>(row) + 0.1, 1e-6);
        }
    }
    constexpr std::uint64_t ofRegions[][2] = {{1, 1},  {2, 2},   {3, 4},   {5, 8},
                                              {9, 16}, {17, 32}, {33, 64}, {65, 100'000}};
    static_assert(std::size(ofRegions) == Calibration::regionRows);
    for (std::size_t row = 0; row < Calibration::regionRows; ++row) {
        calibration.regions[row].fill(0.1F * static_cast<float>(row));
        for (const std::uint64_t step : ofRegions[row]) {
            EXPECT_EQ(probabilityOfRegion(calibration, 1, step), 0.1F * static_cast<float>(row));
        }
    }
    EXPECT_NEAR(probabilityAfter(calibration, 1.5F, 1), 0.105, 1e-6);    // the next knot
    EXPECT_NEAR(probabilityAfter(calibration, 1.25F, 1), 0.1025, 1e-6);  // half-way to it
    EXPECT_NEAR(probabilityAfter(calibration, 1e30F, 1), 0.2, 1e-6);
    EXPECT_NEAR(probabilityAfter(calibration, 0, 1), 0, 1e-6);
    for (std::size_t knot = 0; knot < Calibration::knots; ++knot) {
        EXPECT_NEAR(probabilityAfter(calibration, knotRate(knot), 1), 0.005 * static_cast<double>(knot), 1e-6);
    }
    EXPECT_EQ(knotRate(0), std::exp2(-10.0F));
    EXPECT_EQ(knotRate(Calibration::knots - 1), std::exp2(10.0F));
}

TEST(Calibration, RatesAndProbabilitiesAreInverse) {
    const Calibration& calibration = defaultCalibration();
    int reached = 0;
    for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
        const std::uint64_t steps = row < 16 ? row + 1 : row < 18 ? 8 * row - 111 : 16 * row - 255;
        const auto at = [&](double rate) { return probabilityAfter(calibration, static_cast<float>(rate), steps); };
        for (const float p : {0.0001F, 0.001F, 0.02F, 0.3F, 0.5F, 0.77F, 0.95F, 0.999F, 0.9999F}) {
            const double least = leastRateAt(calibration.bySteps[row], p);
            if (std::isfinite(least) && least > 0) {
                ++reached;
                EXPECT_GE(at(least * 1.0001), p);
                EXPECT_LT(at(least * 0.9999), p + 1e-6F);
                EXPECT_LT(at(least * 0.66), p);
            }
            const double most = mostRateAt(calibration.bySteps[row], p);
            if (std::isfinite(most) && most > 0) {
                EXPECT_LE(at(most * 0.9999), p);
                EXPECT_GT(at(most * 1.51), p);
                EXPECT_LE(least, most * 1.0001);
            }
        }
    }
    EXPECT_GT(reached, 40);
    Calibration::Row flat{};
    EXPECT_EQ(leastRateAt(flat, 0.5F), std::numeric_limits<float>::infinity());
    EXPECT_EQ(mostRateAt(flat, 0.5F), std::numeric_limits<float>::infinity());
    flat.fill(0.8F);
    EXPECT_EQ(leastRateAt(flat, 0.5F), 0);
    EXPECT_EQ(mostRateAt(flat, 0.5F), -1);
}

TEST(Calibration, WholesGoByTheFourthPowerOfTheDistance) {
    Calibration calibration;
    for (std::size_t knot = 0; knot < Calibration::knots; ++knot) {
        calibration.whole[knot] = 0.02F * static_cast<float>(knot);
    }
    EXPECT_NEAR(probabilityOfWholes(calibration, 1), 0.4, 1e-6);
    EXPECT_NEAR(probabilityOfWholes(calibration, 2), 0.32, 1e-6);  // D^2 = 2, D^4 = 4: four knots down
    EXPECT_NEAR(probabilityOfWholes(calibration, 0.5F), 0.48, 1e-6);
    EXPECT_NEAR(probabilityOfWholes(calibration, 1e30F), 0, 1e-6);
    EXPECT_NEAR(probabilityOfWholes(calibration, 0), 0.8, 1e-6);
    float before = 1;
    for (double octaves = -8; octaves <= 8; octaves += 0.1) {
        const float p = probabilityOfWholes(defaultCalibration(), static_cast<float>(std::exp2(octaves)));
        EXPECT_LE(p, before);
        before = p;
    }
    EXPECT_LT(before, 0.002F);
}

TEST(Calibration, TextComesBackToTheLastBit) {
    const Calibration& first = defaultCalibration();
    const std::string text = toText(first);
    const Calibration second = calibrationFrom(text, "copy");
    EXPECT_EQ(second.poses, first.poses);
    EXPECT_EQ(second.formula.constant, first.formula.constant);
    EXPECT_EQ(second.formula.distance, first.formula.distance);
    EXPECT_EQ(second.formula.length, first.formula.length);
    EXPECT_EQ(second.whole, first.whole);
    EXPECT_EQ(second.bySteps, first.bySteps);
    EXPECT_EQ(second.afterwards, first.afterwards);
    EXPECT_EQ(second.regions, first.regions);
    EXPECT_EQ(toText(second), text);
}

void expectRefusal(const std::string& text, const std::string& what) {
    try {
        (void)calibrationFrom(text, "table.txt");
        FAIL() << what;
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::badFile);
        EXPECT_THAT(error.what(), HasSubstr(what));
        EXPECT_THAT(error.what(), HasSubstr("table.txt:"));
    }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return text;
}

TEST(Calibration, NamesWhatIsWrongWithAText) {
    const std::string good = toText(defaultCalibration());
    expectRefusal("", "the text ends here");
    expectRefusal("something else\n", "'something else' where 'grapeshot calibration' should be");
    expectRefusal(replaced(good, "calibration 3", "calibration 2"), "version '2', not 3");
    expectRefusal(replaced(good, "formula ", "formula 7 "), "4 numbers where 3 should be");
    expectRefusal(replaced(good, "steps ", "steps nan "), "is no number");
    expectRefusal(replaced(good, "steps ", "steps 1.5 "), "42 numbers where 41 should be");
    expectRefusal(good + "steps 1\n", "more than there should be");
    // Cut off anywhere, it is refused, unless nothing but the end of the last line is gone.
    for (std::size_t length = 0; length + 1 < good.size(); length += 97) {
        EXPECT_THROW((void)calibrationFrom(good.substr(0, length), "cut"), Error) << length;
    }
    Calibration bad = defaultCalibration();
    bad.bySteps[2][40] = 1.01F;
    expectRefusal(toText(bad), "is no probability");
    bad = defaultCalibration();
    bad.afterwards[1][0] = 0.9F;
    bad.afterwards[1][1] = 0.8F;
    expectRefusal(toText(bad), "they must not fall");
    EXPECT_NO_THROW((void)calibrationFrom(good.substr(0, good.size() - 1), "no last line feed"));
}

}  // namespace
}  // namespace grapeshot::test
