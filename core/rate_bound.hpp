// How large, and how small, may a rate or a count be of which only a sample is known?
//
// This work is based on:
// Charles Clopper, Egon Pearson. The use of confidence or fiducial limits illustrated in the case of the binomial.
// Biometrika 26, 1934
// W. L. Stevens. Fiducial limits of the parameter of a discontinuous distribution. Biometrika 37, 1950
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

/// The most members of a population that may be hits, if `hits` of `sample` members drawn without replacement were: the
/// largest count with which `hits` or fewer still happen with probability above 1 - confidence (the hypergeometric
/// distribution, inverted as Clopper and Pearson do). Exact: `hits` if all were drawn; the population if none was.
/// @param share of the probability of just `hits` that counts, 0..1. With 1 the bound holds in at least `confidence` of
/// all samples, and often in more, because counts are whole. Drawn evenly, it holds in just so many, and is smaller for
/// it (Stevens).
/// @param hits 0..sample; sample 0..population; population up to 2^31; confidence in (0, 1). Asserts them. Some 10 us.
[[nodiscard]] std::uint64_t upperCount(std::uint64_t hits, std::uint64_t sample, std::uint64_t population,
                                       double confidence, double share = 1);

}  // namespace grapeshot
