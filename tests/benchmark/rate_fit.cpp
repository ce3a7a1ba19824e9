// This work is based on:
// Peter McCullagh, John Nelder. Generalized Linear Models. 1989, sections 2.5 and 4.3 (Fisher scoring; log-log link)
#include "rate_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "scoring.hpp"

namespace grapeshot::bench {
namespace {

using Weights = Eigen::Vector3d;

/// Pairs farther apart than this are all the same.
Weights featuresOf(const PairSample& sample) {
    return {1, std::min(sample.squaredDistance, 60.0), std::clamp(sample.length, -40.0, 40.0)};
}

struct FisherScore {
    double loss = 0;
    Weights gradient = Weights::Zero();
    Eigen::Matrix3d information = 1e-6 * Eigen::Matrix3d::Identity();
};

FisherScore scoreOf(const std::vector<PairSample>& samples, const Weights& weights) {
    FisherScore score;
    for (const PairSample& sample : samples) {
        const Weights features = featuresOf(sample);
        const double rate = std::exp(std::clamp(weights.dot(features), -30.0, 6.0));
        const double p = std::clamp(-std::expm1(-rate), 1e-12, 1 - 1e-15);
        score.loss += sample.meet ? -std::log(p) : rate;
        score.gradient += (sample.meet ? -rate * std::exp(-rate) / p : rate) * features;
        score.information += std::max(rate * rate * std::exp(-rate) / p, 1e-12) * features * features.transpose();
    }
    return score;
}

/// Of the formula in base 2.
Weights weightsOf(const RateFormula& formula) {
    return std::log(2.0) * Weights(formula.constant, formula.distance, formula.length);
}

}  // namespace

RateFormula fitRates(const std::vector<PairSample>& samples) {
    Weights weights = Weights::Zero();
    FisherScore score = scoreOf(samples, weights);
    for (int iteration = 0; iteration < 50; ++iteration) {
        const Weights step = score.information.ldlt().solve(score.gradient);
        double share = 1;
        FisherScore next = scoreOf(samples, weights - step);
        while (next.loss > score.loss && share > 1e-6) {
            share /= 2;
            next = scoreOf(samples, weights - share * step);
        }
        if (next.loss >= score.loss) {
            break;
        }
        weights -= share * step;
        score = next;
    }
    const Weights inOctaves = weights / std::log(2.0);
    return {static_cast<float>(inOctaves[0]), static_cast<float>(inOctaves[1]), static_cast<float>(inOctaves[2])};
}

double logLoss(const std::vector<PairSample>& samples, const RateFormula& formula) {
    return scoreOf(samples, weightsOf(formula)).loss / static_cast<double>(samples.size());
}

double areaUnderCurve(const std::vector<PairSample>& samples, const RateFormula& formula) {
    std::vector<Forecast> forecasts;
    for (const PairSample& sample : samples) {
        forecasts.push_back({weightsOf(formula).dot(featuresOf(sample)), sample.meet});  // only the order counts
    }
    return areaUnderCurve(std::move(forecasts));
}

}  // namespace grapeshot::bench
