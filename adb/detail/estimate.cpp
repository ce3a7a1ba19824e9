#include <grapeshot/adb/detail/estimate.hpp>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/adb/detail/estimate.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/adb/detail/cut_wide.hpp>
#include <grapeshot/adb/detail/surface_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// A pair's children: which of the sixteen touch, and how close they are.
struct Tested {
    std::uint32_t mask;
    Closeness closeness;
};
HWY_INLINE Tested test(const Descent& descent, const WidePose& pose, Side a, Side b) {
    Tested out;
    const std::uint32_t meant = withChildren(
        descent, a, b, [&](const auto& childrenA, const auto& childrenB) HWY_ATTR __attribute__((always_inline)) {
            Float16 apart[3];
            out.mask = touching(*pose.pose, marginsOf(pose, childrenA, childrenB, apart));
            out.closeness = closenessOf(surfacePairOf(*pose.pose, childrenA, childrenB, apart));
        });
    out.mask &= meant;
    return out;
}

EstimateEnd toEstimate(Descent& descent, Cut& cut, const RateFormula& formula, const RateLimits& limits,
                       std::uint32_t mostSteps, std::uint64_t units) {
    const WidePose pose = widened(descent.prepared);
    const RateTerms terms = rateTerms(formula, descent.prepared);
    for (;;) {
        if (cut.count == 0) {
            return EstimateEnd::exhausted;
        }
        if (cut.steps > 0) {
            const std::size_t row = Calibration::rowOf(cut.steps);
            const float rate = tunedRate(descent, cut);
            if (rate >= limits.yes[row] || rate <= limits.no[row]) {
                return EstimateEnd::limit;
            }
            if (rate > limits.doubtFrom[row] && rate < limits.doubtTo[row] && mostSteps != endlessSteps) {
                return EstimateEnd::handOver;
            }
        }
        if (cut.steps >= mostSteps || cut.count > mostOfCut) {
            return EstimateEnd::handOver;
        }
        if (units == 0) {
            return EstimateEnd::budget;
        }
        --units;
        ++descent.work;
        SidePair pair = 0;
        if (cut.steps == 0) {
            cut.count = 0;
            pair = sidePair(0, 0);
        } else {
            pair = takeLargest(cut);
        }
        ++cut.steps;
        if (bothLeaves(pair)) {
            descent.lanes = overlapsLeaves(blockA(descent, pair).corner, blockB(descent, pair).corner, descent.pose);
            if (descent.lanes != 0) {
                descent.found = pair;
                return EstimateEnd::found;
            }
            continue;
        }
        const Side a = sideA(pair);
        const Side b = sideB(pair);
        const Tested tested = test(descent, pose, a, b);
        const Float16 counted = select(maskOf(tested.mask), ratesOf(terms, tested.closeness), wide(0));
        cut.rate = cut.rate + sum(counted);
        append(cut, sidesOf(descent.nodesA, a), sidesOf(descent.nodesB, b), counted, tested.mask);
    }
}

void handOver(Descent& descent, Cut& cut) {
    if (cut.count == 0) {
        return;
    }
    const float rate = cut.rate;  // what the probability of the exact part goes by
    const SidePair likeliest = cut.steps == 0 ? sidePair(0, 0) : takeLargest(cut);
    cut.rate = rate;
    while (descent.depth + cutCapacity + stackRoom > descent.capacity) {
        descent.grow(descent);
    }
    for (std::size_t i = 0; i < 16 * cut.blocks; i += 16) {
        const std::uint32_t mask = bits(load(cut.rates + i) > wide(0));
        writeLanes(cut.sidesA + i, mask, descent.stackA + descent.depth);
        descent.depth += writeLanes(cut.sidesB + i, mask, descent.stackB + descent.depth);
    }
    cut.count = 0;
    descent.stackA[descent.depth] = sideA(likeliest);
    descent.stackB[descent.depth++] = sideB(likeliest);
}

int childPairs(const Descent& descent, SidePair pair, ChildPair (&out)[16]) {
    const Tested tested = test(descent, widened(descent.prepared), sideA(pair), sideB(pair));
    const FourSides a = sidesOf(descent.nodesA, sideA(pair));
    const FourSides b = sidesOf(descent.nodesB, sideB(pair));
    alignas(64) float squaredDistance[16];
    alignas(64) float length[16];
    store(squaredDistanceOf(descent.prepared, tested.closeness), squaredDistance);
    store(lengthOf(descent.prepared, tested.closeness), length);
    int count = 0;
    for (std::uint32_t rest = tested.mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        out[count++] = {sidePair(a.side[lane >> 2U], b.side[lane & 3U]), squaredDistance[lane], length[lane]};
    }
    return count;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

EstimateEnd toEstimate(Descent& descent, Cut& cut, const RateFormula& formula, const RateLimits& limits,
                       std::uint32_t mostSteps, std::uint64_t units) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(toEstimate);
    return kernel.chosen()(descent, cut, formula, limits, mostSteps, units);
}

void handOver(Descent& descent, Cut& cut) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(handOver);
    kernel.chosen()(descent, cut);
}

int childPairs(const Descent& descent, SidePair pair, ChildPair (&out)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(childPairs);
    return kernel.chosen()(descent, pair, out);
}

}  // namespace grapeshot::detail
#endif
