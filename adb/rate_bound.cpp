#include <grapeshot/adb/rate_bound.hpp>

#include <cassert>
#include <cmath>

#include <grapeshot/adb/detail/incomplete_beta.hpp>

namespace grapeshot {

double upperRate(std::uint64_t count, std::uint64_t trials, double confidence) {
    assert(count <= trials && confidence > 0 && confidence < 1);
    if (count == trials) {
        return 1;
    }
    // P(count or fewer of trials | rate) = 1 - I_rate(count + 1, trials - count), falling in the rate.
    const auto a = static_cast<double>(count) + 1;
    const auto b = static_cast<double>(trials - count);
    const double level = std::log1p(-confidence);
    double low = static_cast<double>(count) / static_cast<double>(trials);
    double high = 1;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (detail::logIncompleteBetaAbove(middle, a, b) > level ? low : high) = middle;
    }
    return high;  // the safe side
}

double lowerRate(std::uint64_t count, std::uint64_t trials, double confidence) {
    assert(count <= trials);
    return trials == 0 ? 0 : 1 - upperRate(trials - count, trials, confidence);
}

std::uint64_t fewestTrials(double rate, double confidence) {
    assert(rate > 0 && rate < 1 && confidence > 0 && confidence < 1);
    return static_cast<std::uint64_t>(std::ceil(std::log1p(-confidence) / std::log1p(-rate)));
}

}  // namespace grapeshot
