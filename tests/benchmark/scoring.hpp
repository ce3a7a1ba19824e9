// How good probabilities are: how often the likelier answer is wrong, whether the colliding come out on top, and
// whether a probability of 0.7 comes true seven times of ten.
//
// This work is based on:
// Glenn W. Brier. Verification of Forecasts Expressed in Terms of Probability. Monthly Weather Review 78, 1950
// Mahdi Pakdaman Naeini, Gregory Cooper, Milos Hauskrecht. Obtaining Well Calibrated Probabilities Using Bayesian
// Binning. AAAI 2015 (expected calibration error)
#pragma once

#include <cstddef>
#include <vector>

namespace grapeshot::bench {

struct Forecast {
    double probability = 0.5;  ///< that they collide
    bool collides = false;     ///< the truth
};

struct Bin {
    std::size_t count = 0;
    double probability = 0;  ///< mean
    double share = 0;        ///< of those that collide
};
/// Bins of the same width, 1 / count; empty ones are left out.
[[nodiscard]] std::vector<Bin> binsOfEqualWidth(const std::vector<Forecast>& forecasts, std::size_t count);
/// Bins of as many forecasts each, but that equal ones are not parted.
[[nodiscard]] std::vector<Bin> binsOfEqualCount(std::vector<Forecast> forecasts, std::size_t count);
/// Expected calibration error: mean of |probability - share|, weighted by count.
[[nodiscard]] double calibrationError(const std::vector<Bin>& bins);

/// P(a colliding one has more than a clear one); ties count half. NaN if there are none of a kind.
[[nodiscard]] double areaUnderCurve(std::vector<Forecast> forecasts);

struct Score {
    std::size_t n = 0, colliding = 0;
    double falseNegatives = 0, falsePositives = 0;  ///< of the answer "at least 0.5"
    double errorPercent = 0;
    double auc = 0;    ///< P(a colliding pose has more than a clear one), ties count half; NaN if one is missing
    double brier = 0;  ///< mean squared difference from the truth
    double ece = 0;    ///< 20 bins of equal width: what is claimed
    double eceEqualCount = 0;  ///< 15 bins of equal count
    std::size_t inDoubt = 0;   ///< forecasts with a probability from 0.1 to 0.9
    double eceInDoubt = 0;     ///< of those, 20 bins of equal width
};
[[nodiscard]] Score score(const std::vector<Forecast>& forecasts);

}  // namespace grapeshot::bench
