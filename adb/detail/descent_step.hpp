// One step of a descent: the sixteen pairs below a pair, and those of them that touch onto the stack.
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_DESCENT_STEP_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_DESCENT_STEP_HPP
#undef GRAPESHOT_ADB_DETAIL_DESCENT_STEP_HPP
#else
#define GRAPESHOT_ADB_DETAIL_DESCENT_STEP_HPP
#endif

#include <grapeshot/adb/detail/child_sides.hpp>

#include <limits>

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

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
