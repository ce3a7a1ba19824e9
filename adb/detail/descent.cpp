#include <grapeshot/adb/detail/descent.hpp>

#include <limits>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/adb/detail/descent.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/adb/detail/child_sides.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// The sixteen pairs below a pair: which of them touch, and by how much, m.
struct Tested {
    std::uint32_t mask;
    Float16 margin;
};
HWY_INLINE Tested test(const Descent& descent, const WidePose& pose, Side a, Side b) {
    Tested out;
    const std::uint32_t meant = withChildren(
        descent, a, b, [&](const auto& childrenA, const auto& childrenB) HWY_ATTR __attribute__((always_inline)) {
            Float16 apart[3];
            out.margin = marginsOf(pose, childrenA, childrenB, apart);
            out.mask = touching(*pose.pose, out.margin);
        });
    out.mask &= meant;
    return out;
}

/// Pushes the touching children, the one with the largest margin last, so that it is taken up next; the others stay in
/// the order of their lanes. Sorting them all costs more than it saves.
HWY_INLINE void push(Descent& descent, Side a, Side b, const Tested& tested) {
    if (tested.mask == 0) {
        return;
    }
    if (descent.depth + stackRoom > descent.capacity) [[unlikely]] {
        descent.grow(descent);
    }
    const Float16 margins = select(maskOf(tested.mask), tested.margin, wide(-std::numeric_limits<float>::infinity()));
    // Nothing is equal if the largest is NaN.
    const std::uint32_t best = bits(margins == wide(largestLane(margins))) & tested.mask;
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(best != 0 ? best : tested.mask));
    const FourSides fourA = sidesOf(descent.nodesA, a);
    const FourSides fourB = sidesOf(descent.nodesB, b);
    Side* const outA = descent.stackA + descent.depth;
    Side* const outB = descent.stackB + descent.depth;
    const std::size_t others = writeLanes(fourA, fourB, tested.mask & ~(1U << lane), outA, outB);
    outA[others] = fourA.side[lane >> 2U];
    outB[others] = fourB.side[lane & 3U];
    descent.depth += others + 1;
}

HWY_INLINE SidePair top(const Descent& descent) {
    return sidePair(descent.stackA[descent.depth - 1], descent.stackB[descent.depth - 1]);
}

DescentEnd toOverlap(Descent& descent, std::uint64_t units) {
    const WidePose pose = widened(descent.prepared);
    for (; descent.depth > 0; --units) {
        if (units == 0) {
            return DescentEnd::budget;
        }
        ++descent.work;
        const SidePair pair = top(descent);
        --descent.depth;
        const Side a = sideA(pair);
        const Side b = sideB(pair);
        if (isLeaf(a & b)) {
            const std::uint32_t lanes =
                overlapsLeaves(blockA(descent, pair).corner, blockB(descent, pair).corner, descent.pose);
            if (lanes != 0) {
                descent.found = pair;
                descent.lanes = lanes;
                return DescentEnd::found;
            }
            continue;
        }
        push(descent, a, b, test(descent, pose, a, b));
    }
    return DescentEnd::exhausted;
}

DescentEnd toLeafPair(Descent& descent, std::uint64_t units) {
    const WidePose pose = widened(descent.prepared);
    while (descent.depth > 0) {
        const SidePair pair = top(descent);
        if (bothLeaves(pair)) {
            --descent.depth;
            descent.found = pair;
            return DescentEnd::found;
        }
        if (units == 0) {
            return DescentEnd::budget;
        }
        --units;
        ++descent.work;
        --descent.depth;
        const Side a = sideA(pair);
        const Side b = sideB(pair);
        push(descent, a, b, test(descent, pose, a, b));
    }
    return DescentEnd::exhausted;
}

int touchingChildren(const Descent& descent, SidePair pair, TouchingChild (&children)[16]) {
    const WidePose pose = widened(descent.prepared);
    const Side a = sideA(pair);
    const Side b = sideB(pair);
    const Tested tested = test(descent, pose, a, b);
    const FourSides fourA = sidesOf(descent.nodesA, a);
    const FourSides fourB = sidesOf(descent.nodesB, b);
    alignas(64) float margin[16];
    store(tested.margin, margin);
    int count = 0;
    for (std::uint32_t rest = tested.mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        children[count].pair = sidePair(fourA.side[lane >> 2U], fourB.side[lane & 3U]);
        children[count].margin = margin[lane];
        ++count;
    }
    return count;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

DescentEnd toOverlap(Descent& descent, std::uint64_t units) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(toOverlap);
    return kernel.chosen()(descent, units);
}

DescentEnd toLeafPair(Descent& descent, std::uint64_t units) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(toLeafPair);
    return kernel.chosen()(descent, units);
}

int touchingChildren(const Descent& descent, SidePair pair, TouchingChild (&children)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(touchingChildren);
    return kernel.chosen()(descent, pair, children);
}

}  // namespace grapeshot::detail
#endif
