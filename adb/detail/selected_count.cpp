#include <grapeshot/adb/detail/selected_count.hpp>

#include <cmath>

#include <grapeshot/core/detail/incomplete_beta.hpp>

namespace grapeshot::detail {
namespace {

constexpr double prior = 0.5;  // both parameters of the beta prior: Krichevsky and Trofimov's, much weight near 0

/// log of the mean likelihood ratio over all q, before either side is cut off.
double logMixture(double seen, double unseen, double share) noexcept {
    return logBeta(prior + seen, prior + unseen) - logBeta(prior, prior) - seen * std::log(share) -
           unseen * std::log1p(-share);
}

}  // namespace

double logTooFewSeen(std::uint64_t total, std::uint64_t seen, double share) noexcept {
    const auto s = static_cast<double>(seen);
    const auto rest = static_cast<double>(total - seen);
    return logMixture(s, rest, share) + logIncompleteBeta(share, prior + s, prior + rest) -
           logIncompleteBeta(share, prior, prior);
}

double logTooManySeen(std::uint64_t total, std::uint64_t seen, double share) noexcept {
    const auto s = static_cast<double>(seen);
    const auto rest = static_cast<double>(total - seen);
    return logMixture(s, rest, share) + logIncompleteBetaAbove(share, prior + s, prior + rest) -
           logIncompleteBetaAbove(share, prior, prior);
}

std::uint64_t mostWithSeen(std::uint64_t seen, double share, double confidence, std::uint64_t atMost) noexcept {
    const double limit = -std::log1p(-confidence);
    const auto excluded = [&](std::uint64_t total) { return logTooFewSeen(total, seen, share) >= limit; };
    if (atMost <= seen || !excluded(atMost)) {
        return atMost;
    }
    // With total == seen everything was seen: never excluded.
    std::uint64_t possible = seen;
    std::uint64_t step = 1 + static_cast<std::uint64_t>(1 / share);
    while (possible + step < atMost && !excluded(possible + step)) {
        possible += step;
        step *= 2;
    }
    std::uint64_t impossible = possible + step < atMost ? possible + step : atMost;
    while (impossible - possible > 1) {
        const std::uint64_t middle = possible + (impossible - possible) / 2;
        (excluded(middle) ? impossible : possible) = middle;
    }
    return possible;
}

std::uint64_t fewestWithSeen(std::uint64_t seen, double share, double confidence) noexcept {
    const double limit = -std::log1p(-confidence);
    const auto excluded = [&](std::uint64_t total) { return logTooManySeen(total, seen, share) >= limit; };
    if (!excluded(seen)) {
        return seen;
    }
    // At seen / share as many were seen as are to be expected: far from excluded.
    std::uint64_t impossible = seen;
    std::uint64_t possible = seen + static_cast<std::uint64_t>(static_cast<double>(seen) / share) + 1;
    while (possible - impossible > 1) {
        const std::uint64_t middle = impossible + (possible - impossible) / 2;
        (excluded(middle) ? impossible : possible) = middle;
    }
    return possible;
}

}  // namespace grapeshot::detail
