// What a step may have missed.
//
// This work is based on:
// Charles Clopper, Egon Pearson. The use of confidence or fiducial limits illustrated in the case of the binomial.
// Biometrika 26, 1934 (here for a population and a sample without replacement)
// W. L. Stevens. Fiducial limits of the parameter of a discontinuous distribution. Biometrika 37, 1950
// Irving Good. The population frequencies of species and the estimation of population parameters. Biometrika 40, 1953
// David McAllester, Robert Schapire. On the convergence rate of Good-Turing estimators. COLT 2000
#pragma once

#include <cstdint>
#include <limits>

namespace grapeshot {

/// Counts pairs of cells: each surface is cut into so many pieces (TrackSettings::frontCells), and the pairs whose
/// balls are within the distance are the candidates; nothing is in contact outside of them. A contact cell is a
/// candidate with a contact. Those without a reported one are what was missed.
struct MissEstimate {
    std::uint64_t candidates = 0;
    std::uint64_t reported = 0;  ///< contact cells with a reported contact
    std::uint64_t unknown = 0;   ///< candidates without one when the sample was drawn
    std::uint64_t sampled = 0;   ///< of the unknown ones, drawn uniformly without replacement
    std::uint64_t hits = 0;      ///< of the sample: contact cells (they are reported, too)
    std::uint64_t open = 0;  ///< of the sample: not finished when the budget ended; each counts as a hit in the bound
    /// Contact cells without a reported contact: unbiased estimate, NaN if nothing was sampled of something.
    double missed = std::numeric_limits<double>::quiet_NaN();
    /// ... and a bound that holds in 95 % of all draws, whatever the surfaces do, and is 0 only if nothing is left to
    /// be sampled; infinite if the candidates are not known because the budget ended before.
    double missedBound = std::numeric_limits<double>::infinity();
    /// Of the dives of this step: probability that another one finds a contact that none of them has found (Good and
    /// Turing's f1 / n), and a bound, f1 / n + (2 sqrt(f1 + 1) + 1) / n. It says nothing of contacts that a dive has no
    /// chance to find. NaN without dives.
    double unseen = std::numeric_limits<double>::quiet_NaN();
    double unseenBound = std::numeric_limits<double>::quiet_NaN();
};

/// Fills `missed` and `missedBound` from the counts. @param complete all candidates are known
/// @param draw evenly from 0..1, by chance: counts are whole, so that a bound by them alone holds more often than it
/// says and is wider for it. With 1 it is that one.
void estimateMissed(MissEstimate& miss, bool complete, double draw = 1) noexcept;
/// Fills `unseen` and `unseenBound`. @param once contacts that exactly one of the dives has found
void estimateUnseen(MissEstimate& miss, std::uint64_t once, std::uint64_t dives) noexcept;

}  // namespace grapeshot
