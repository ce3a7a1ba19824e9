// How large, and how small, may a rate be of which only a sample is known?
//
// This work is based on:
// Charles Clopper, Egon Pearson. The use of confidence or fiducial limits illustrated in the case of the binomial.
// Biometrika 26, 1934
#pragma once

#include <cstdint>

namespace grapeshot {

/// The largest rate with which `count` or fewer of `trials` independent trials still happen with probability
/// 1 - confidence: an upper bound that holds in at least `confidence` of all samples. 1 if there were no trials or all
/// hit. @param count 0..trials; confidence in (0, 1). Asserts both. About 10 us.
[[nodiscard]] double upperRate(std::uint64_t count, std::uint64_t trials, double confidence);

/// The lower bound, likewise; 0 if nothing hit.
[[nodiscard]] double lowerRate(std::uint64_t count, std::uint64_t trials, double confidence);

/// The fewest trials of which none may hit for the upper bound to be at most `rate`, 0 < rate < 1:
/// log(1 - confidence) / log(1 - rate), 299 for 1 % at 95 %.
[[nodiscard]] std::uint64_t fewestTrials(double rate, double confidence);

}  // namespace grapeshot
