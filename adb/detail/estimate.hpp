// The probabilistic descent: the likeliest pair of the cut is replaced by its children until the sum of the rates says
// enough.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003, fig. 4
// (best first by the estimated probability; here the rates of all pairs of the cut add up, and it stops on both sides)
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/detail/descent.hpp>

namespace grapeshot::detail {

/// When to stop: in a row of the calibration's steps at yes[row] or more, at no[row] or less.
struct RateLimits {
    float yes[Calibration::stepRows];
    float no[Calibration::stepRows];
    /// Between these two the exact traversal takes over at once, unless there is none to follow: too far from both.
    float doubtFrom[Calibration::stepRows];
    float doubtTo[Calibration::stepRows];
};
/// Rates are never so large, and never so small.
inline constexpr float unreachableYes = std::numeric_limits<float>::infinity();
inline constexpr float unreachableNo = -1;
inline constexpr RateLimits noLimits = [] {
    RateLimits limits{};
    for (std::size_t row = 0; row < Calibration::stepRows; ++row) {
        limits.yes[row] = unreachableYes;
        limits.no[row] = unreachableNo;
        limits.doubtFrom[row] = unreachableYes;
        limits.doubtTo[row] = unreachableNo;
    }
    return limits;
}();

/// A cut through the tree of pairs: every pair that touches lies below one of its entries, or was tested. Plain data,
/// in borrowed memory, in blocks of sixteen: the children of one step stay where their lanes are, so that what was just
/// stored is read as it was stored.
struct Cut {
    Side* sidesA = nullptr;  ///< room for cutCapacity entries each
    Side* sidesB = nullptr;
    float* rates = nullptr;  ///< 0 where there is no entry; also in the blocks up to the next multiple of four
    std::size_t blocks = 0;
    std::size_t count = 0;    ///< entries; before the first step one, the root, which is not in the blocks
    float rate = 0;           ///< sum of all rates
    std::uint32_t steps = 0;  ///< taken, of either kind
};
/// A cut with more entries is not searched any further: looking for the likeliest costs more than it brings.
inline constexpr std::size_t mostOfCut = 224;
inline constexpr std::size_t cutCapacity = 256;
inline constexpr std::size_t mostBlocks = cutCapacity / 16;
static_assert(mostOfCut <= 16 * (mostBlocks - 1) && mostBlocks % 4 == 0);

/// The root alone.
inline void startCut(Cut& cut) noexcept {
    cut.blocks = 0;
    cut.count = 1;
    cut.rate = 0;
    cut.steps = 0;
}

/// Index of Tree::stepRates, after one step or more.
[[nodiscard]] constexpr std::size_t stepRateOf(std::uint64_t steps) noexcept {
    return static_cast<std::size_t>(steps <= 2 ? steps - 1 : steps <= 4 ? 2 : 3);
}

/// The sum of the rates as the calibration knows it, after one step or more.
[[nodiscard]] inline float tunedRate(const Descent& descent, const Cut& cut) noexcept {
    return descent.stepRates[stepRateOf(cut.steps)] * cut.rate;
}

/// Of `mostSteps`: the estimate never hands over while the cut is not too large.
inline constexpr std::uint32_t endlessSteps = std::numeric_limits<std::uint32_t>::max();

/// Probabilities between these two are as good as undecided: the odds are so many times from both limits that the next
/// steps seldom reach one of them. No doubt if from >= to.
struct Doubt {
    float from, to;
};
[[nodiscard]] inline Doubt doubtBetween(float rejectAt, float acceptAt) noexcept {
    constexpr float farOdds = 64;
    const auto withOdds = [](float p, float factor) { return factor * p / (factor * p + 1 - p); };
    return {withOdds(rejectAt, farOdds), withOdds(acceptAt, 1 / farOdds)};
}

enum class EstimateEnd {
    exhausted,  ///< the cut is empty: the surfaces are apart
    found,      ///< at Descent::found, which is off the cut: they intersect
    limit,      ///< the rate is beyond a limit
    handOver,   ///< `mostSteps` taken, in doubt, or the cut too large
    budget,
};

/// From where the cut is, spending at most `units`.
EstimateEnd toEstimate(Descent& descent, Cut& cut, const RateFormula& formula, const RateLimits& limits,
                       std::uint32_t mostSteps, std::uint64_t units) noexcept;

/// All of the cut to the stack, the likeliest on top; the others in their order, which costs a few steps less than
/// sorting them would. The cut is empty afterwards.
void handOver(Descent& descent, Cut& cut) noexcept;

/// What the rate of a pair of children is made of.
struct ChildPair {
    SidePair pair;
    float squaredDistance;  ///< D^2
    float length;           ///< L
};
/// Of the touching children of a pair that is not a pair of leaves, in the order of the lanes. For fitting and for
/// contacts; one unit, not counted here.
int childPairs(const Descent& descent, SidePair pair, ChildPair (&out)[16]) noexcept;

}  // namespace grapeshot::detail
