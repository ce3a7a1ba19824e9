// The formula of the rates from pairs of surface pieces that do or do not meet.
#pragma once

#include <vector>

#include <grapeshot/adb/calibration.hpp>

namespace grapeshot::bench {

struct PairSample {
    double squaredDistance, length;  ///< D^2 and L of the pair
    bool meet;                       ///< do any of their triangles intersect?
};

/// Largest likelihood of P(meet) = 1 - exp(-rate), by Fisher scoring: a generalised linear model with the complementary
/// log-log link.
[[nodiscard]] RateFormula fitRates(const std::vector<PairSample>& samples);

/// Mean of -log P(what was seen).
[[nodiscard]] double logLoss(const std::vector<PairSample>& samples, const RateFormula& formula);

/// P(a pair that meets has the larger rate than one that does not).
[[nodiscard]] double areaUnderCurve(const std::vector<PairSample>& samples, const RateFormula& formula);

}  // namespace grapeshot::bench
