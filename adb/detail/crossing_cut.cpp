#include <grapeshot/adb/detail/crossing_cut.hpp>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/adb/detail/crossing_cut.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/adb/detail/child_sides.hpp>
#include <grapeshot/adb/detail/crossing_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Takes the most urgent entry (of equal ones the first) out. False if there is none.
HWY_INLINE bool takeMostUrgent(CrossingCut& cut, SidePair& pair) {
    Float16 largest = wide(0);
    for (std::size_t i = 0; i < cut.count; ++i) {
        largest = max(load(cut.urgency[i]), largest);
    }
    const float most = largestLane(largest);
    if (!(most > 0)) {
        return false;
    }
    for (std::size_t i = 0; i < cut.count; ++i) {
        const std::uint32_t mask = bits(load(cut.urgency[i]) == wide(most));
        if (mask != 0) {
            const auto lane = static_cast<std::uint32_t>(__builtin_ctz(mask));
            cut.urgency[i][lane] = 0;
            pair = sidePair(cut.block[i].sidesA[lane], cut.block[i].sidesB[lane]);
            break;
        }
    }
    return true;
}

/// Leaves out what is not there. How many are.
std::size_t compact(CrossingCut& cut) {
    std::size_t left = 0;
    for (std::size_t i = 0; i < cut.count; ++i) {
        for (std::uint32_t rest = bits(load(cut.urgency[i]) > wide(0)); rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(__builtin_ctz(rest));
            const CrossingBlock& from = cut.block[i];
            CrossingBlock& to = cut.block[left / 16];
            const std::size_t place = left % 16;
            const auto move = [&](auto& target, const auto& source) HWY_ATTR { target[place] = source[lane]; };
            move(cut.urgency[left / 16], cut.urgency[i]);
            for (int axis = 0; axis < 3; ++axis) {
                move(to.position[axis], from.position[axis]);
                move(to.direction[axis], from.direction[axis]);
            }
            move(to.length, from.length);
            move(to.extent, from.extent);
            move(to.flatness, from.flatness);
            move(to.cosine, from.cosine);
            move(to.rate, from.rate);
            move(to.sidesA, from.sidesA);
            move(to.sidesB, from.sidesB);
            ++left;
        }
    }
    cut.count = (left + 15) / 16;
    for (std::size_t i = left; i < 16 * cut.count; ++i) {
        cut.urgency[i / 16][i % 16] = 0;
    }
    return left;
}

/// Appends the lanes of the mask.
HWY_INLINE void append(CrossingCut& cut, const FourSides& a, const FourSides& b, const Crossings& crossings,
                       Float16 rates, std::uint32_t mask) {
    constexpr float leastUrgency = 1e-37F;
    store(select(maskOf(mask), max(crossings.length * crossings.extent, wide(leastUrgency)), wide(0)),
          cut.urgency[cut.count]);
    CrossingBlock& block = cut.block[cut.count++];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        store(crossings.position[i], block.position[i]);
        store(crossings.direction[i], block.direction[i]);
    }
    store(crossings.length, block.length);
    store(crossings.extent, block.extent);
    store(crossings.flatness, block.flatness);
    store(crossings.cosine, block.cosine);
    store(rates, block.rate);
    storeSides(a, b, block.sidesA, block.sidesB);
}

HWY_INLINE void expand(const Descent& descent, const WidePose& pose, SidePair pair, const RateTerms& terms,
                       CrossingCut& cut) {
    const Side a = sideA(pair);
    const Side b = sideB(pair);
    std::uint32_t mask = 0;
    Crossings crossings;
    mask = withChildren(
               descent, a, b,
               [&](const auto& childrenA, const auto& childrenB) HWY_ATTR __attribute__((always_inline)) {
                   Float16 apart[3];
                   mask = touching(*pose.pose, marginsOf(pose, childrenA, childrenB, apart));
                   crossings = crossingsOf(*pose.pose, childrenA, childrenB, apart);
               }) &
           mask;
    const Float16 rates = ratesOf(terms, crossings.closeness);
    append(cut, sidesOf(descent.nodesA, a), sidesOf(descent.nodesB, b), crossings, rates, mask);
}

CrossingEnd refineCrossing(Descent& descent, CrossingCut& cut, const RateFormula& formula, std::uint64_t units) {
    const WidePose pose = widened(descent.prepared);
    const RateTerms terms = rateTerms(formula, descent.prepared);
    for (;;) {
        SidePair pair = 0;
        if (cut.count == crossingBlocks && compact(cut) > mostOfCrossing) {
            takeMostUrgent(cut, pair);
            push(descent, pair);
            return CrossingEnd::full;
        }
        if (units == 0) {
            return CrossingEnd::budget;
        }
        if (!takeMostUrgent(cut, pair)) {
            return CrossingEnd::exhausted;
        }
        --units;
        ++descent.work;
        if (!bothLeaves(pair)) {
            expand(descent, pose, pair, terms, cut);
            continue;
        }
        descent.lanes = overlapsLeaves(blockA(descent, pair).corner, blockB(descent, pair).corner, descent.pose);
        if (descent.lanes != 0) {
            descent.found = pair;
            return CrossingEnd::found;
        }
    }
}

CrossingSummary summarise(const CrossingCut& cut, float proven, float leaveOut, std::uint32_t* places) {
    const auto there = [&](std::size_t i) HWY_ATTR { return load(cut.urgency[i]) > wide(0); };
    const auto lengths = [&](std::size_t i) HWY_ATTR { return select(there(i), load(cut.block[i].length), wide(0)); };
    Float16 sums = wide(0);
    Float16 counts = wide(0);
    Float16 rates = wide(0);
    for (std::size_t i = 0; i < cut.count; ++i) {
        sums = sums + lengths(i);
        counts = counts + select(there(i), wide(1), wide(0));
        rates = rates + select(there(i), load(cut.block[i].rate), wide(0));
    }
    const float open = sum(sums);
    const float allowance = leaveOut * (proven + open);
    if (leaveOut > 0 && open <= allowance) {
        return {0, sum(rates)};
    }
    const float all = sum(counts);
    // So many entries, each shorter than its share of the allowance, are within it. Longer limits are tried before.
    float limit = 16 * allowance / (all > 1 ? all : 1);
    for (int halvings = 0; halvings < 4; ++halvings, limit *= 0.5F) {
        Float16 shorter = wide(0);
        for (std::size_t i = 0; i < cut.count; ++i) {
            shorter = shorter + select(lengths(i) < wide(limit), lengths(i), wide(0));
        }
        if (sum(shorter) <= allowance) {
            break;
        }
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < cut.count; ++i) {
        std::uint32_t mask = bits(there(i)) & bits(load(cut.block[i].length) >= wide(limit));
        for (; mask != 0; mask &= mask - 1) {
            places[count++] = static_cast<std::uint32_t>(16 * i) + static_cast<std::uint32_t>(__builtin_ctz(mask));
        }
    }
    return {count, sum(rates)};
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

void startCrossing(CrossingCut& cut) noexcept {
    for (float& urgency : cut.urgency[0]) {
        urgency = 0;
    }
    cut.urgency[0][0] = 1;
    cut.block[0].sidesA[0] = 0;
    cut.block[0].sidesB[0] = 0;
    cut.count = 1;
}

CrossingEnd refineCrossing(Descent& descent, CrossingCut& cut, const RateFormula& formula,
                           std::uint64_t units) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(refineCrossing);
    return kernel.chosen()(descent, cut, formula, units);
}

CrossingSummary summarise(const CrossingCut& cut, float proven, float leaveOut, std::uint32_t* places) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(summarise);
    return kernel.chosen()(cut, proven, leaveOut, places);
}

}  // namespace grapeshot::detail
#endif
