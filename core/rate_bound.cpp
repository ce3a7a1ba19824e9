#include <grapeshot/core/rate_bound.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <grapeshot/core/detail/incomplete_beta.hpp>

namespace grapeshot {

namespace {

double logChoose(double n, double k) {
    return -std::log1p(n) - detail::logBeta(n - k + 1, k + 1);
}

/// P(fewer than `hits` of `sample`) + share * P(`hits`) if `total` of the population are hits.
double hypergeometricTail(std::uint64_t hits, std::uint64_t sample, std::uint64_t population, std::uint64_t total,
                          double share) {
    const std::uint64_t clear = population - total;
    const std::uint64_t fewest = sample > clear ? sample - clear : 0;
    const std::uint64_t most = std::min({hits, total, sample});
    if (fewest > most) {
        return 0;
    }
    const auto real = [](std::uint64_t x) { return static_cast<double>(x); };
    // Downwards from the last term, which is the largest where the tail is small.
    double term = std::exp(logChoose(real(total), real(most)) + logChoose(real(clear), real(sample - most)) -
                           logChoose(real(population), real(sample)));
    double sum = most == hits ? share * term : term;
    for (std::uint64_t i = most; i > fewest; --i) {
        term *= real(i) * real(clear - sample + i) / (real(total - i + 1) * real(sample - i + 1));
        sum += term;
    }
    return sum;
}

}  // namespace

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

std::uint64_t upperCount(std::uint64_t hits, std::uint64_t sample, std::uint64_t population, double confidence,
                         double share) {
    assert(hits <= sample && sample <= population && confidence > 0 && confidence < 1 && share >= 0 && share <= 1);
    std::uint64_t low = hits;                           // possible
    std::uint64_t high = population - (sample - hits);  // the most there is room for
    while (low < high) {
        const std::uint64_t middle = low + (high - low + 1) / 2;
        if (hypergeometricTail(hits, sample, population, middle, share) > 1 - confidence) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

}  // namespace grapeshot
