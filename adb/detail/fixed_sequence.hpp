// One path of settings, from the safest to the fastest, tested in this order until the first that fails.
//
// This work is based on:
// Anastasios Angelopoulos, Stephen Bates, Emmanuel Candes, Michael Jordan, Lihua Lei. Learn then Test: Calibrating
// Predictive Algorithms to Achieve Risk Control. Annals of Applied Statistics, 2025 (fixed-sequence testing)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace grapeshot::detail {

/// The most errors in `trials` with which the rate is still certainly enough (upperRate) at most `limit`; -1: not even
/// none would do.
[[nodiscard]] std::int64_t mostErrorsAllowed(std::uint64_t trials, double limit, double confidence);

struct PathEnd {
    std::size_t passed = 0;    ///< levels that passed, from the front; 0: not even the safest
    std::uint64_t errors = 0;  ///< of the last that passed
};

/// Walks the levels in order, given how many errors each has on the same sample. All levels that passed have a rate
/// within the limit of `mostErrors` together, with its confidence and without a correction for their number: for one
/// that is too bad to pass, the first too bad one on the path would have to pass, and which one that is no data
/// decides.
[[nodiscard]] PathEnd walkPath(std::span<const std::uint64_t> errors, std::int64_t mostErrors) noexcept;

}  // namespace grapeshot::detail
