// How many were there, if this many of them were picked by our own coin?
//
// Errors come one after the other, in any number, at any rate, as dependent on each other and on the past as they like.
// At each of them, after it has happened, a coin of known probability p says whether it is looked at. Of k errors S are
// seen. For any q the likelihood ratio
//     (q / p)^S ((1 - q) / (1 - p))^(k - S)
// is a martingale in the errors, because the coins are independent of all else: its mean stays 1 whatever made the
// errors. So is its mean over q by a prior, here Beta(1/2, 1/2) on q < p (too few seen) or on q > p (too many). By
// Ville's inequality it ever exceeds 1 / delta with probability delta at most. The k at which it has not are therefore
// a confidence sequence for the number of errors: it holds at all times together. Answers without an error do not
// enter, so nothing is assumed of them either; and the average error so far is the number over the answers so far.
//
// This work is based on:
// Jean Ville. Etude critique de la notion de collectif. 1939
// Steven Howard, Aaditya Ramdas, Jon McAuliffe, Jasjeet Sekhon. Time-uniform, nonparametric, nonasymptotic confidence
// sequences. Annals of Statistics 49, 2021 (the beta-binomial mixture, one-sided)
// Ian Waudby-Smith, Aaditya Ramdas. Estimating means of bounded random variables by betting. JRSS B 86, 2024 (running
// means by test martingales; here the bet is against the coin, and the errors are fixed)
#pragma once

#include <cstdint>

namespace grapeshot::detail {

/// Log of the martingale that grows when too few have been seen: rises with `total`, falls with `seen` <= total.
/// share: p, in (0, 1).
[[nodiscard]] double logTooFewSeen(std::uint64_t total, std::uint64_t seen, double share) noexcept;
/// Log of the one that grows when too many have been seen: falls with `total`, rises with `seen`.
[[nodiscard]] double logTooManySeen(std::uint64_t total, std::uint64_t seen, double share) noexcept;

/// The most there can have been with this many seen, not above `atMost` (>= seen): at all times together with
/// probability `confidence`. With a share of 1 % and 97.5 %: 454 if none was seen, 750 if 1, 2,359 if 10, 13,830 if
/// 100. Some 10 us.
[[nodiscard]] std::uint64_t mostWithSeen(std::uint64_t seen, double share, double confidence,
                                         std::uint64_t atMost) noexcept;

/// The fewest there can have been, likewise; at least `seen`.
[[nodiscard]] std::uint64_t fewestWithSeen(std::uint64_t seen, double share, double confidence) noexcept;

}  // namespace grapeshot::detail
