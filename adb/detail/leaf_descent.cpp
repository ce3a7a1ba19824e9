#include <grapeshot/adb/detail/leaf_descent.hpp>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/adb/detail/leaf_descent.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/adb/detail/descent_step.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

template <class Children>
HWY_INLINE void extend(const Children& children, Mask16 lanes, float (&lower)[3][16], float (&upper)[3][16]) {
    for (int axis = 0; axis < 3; ++axis) {
        const Float16 center = children.wideOf(children.node->center[axis]);
        const Float16 half = children.wideOf(children.node->half[axis]);
        const Float16 low = load(lower[axis]);
        const Float16 high = load(upper[axis]);
        store(select(lanes, min(low, center - half), low), lower[axis]);
        store(select(lanes, max(high, center + half), high), upper[axis]);
    }
}

/// Lanes that mean nothing repeat those that do: they do not change the boxes.
HWY_INLINE Tested test(const Descent& descent, const WidePose& pose, Side a, Side b, PassedBy& passed) {
    Tested out;
    const std::uint32_t meant = withChildren(
        descent, a, b, [&](const auto& childrenA, const auto& childrenB) HWY_ATTR __attribute__((always_inline)) {
            Float16 apart[3];
            out.margin = marginsOf(pose, childrenA, childrenB, apart);
            out.mask = touching(*pose.pose, out.margin);
            const Mask16 near = (out.margin < wide(pose.pose->threshold)) & (out.margin >= wide(passed.threshold));
            if (any(near)) {
                extend(childrenA, near, passed.lower[0], passed.upper[0]);
                extend(childrenB, near, passed.lower[1], passed.upper[1]);
            }
        });
    out.mask &= meant;
    return out;
}

DescentEnd toLeafPairs(Descent& descent, LeafPairBatch& batch, PassedBy& passed) {
    const WidePose pose = widened(descent.prepared);
    batch.count = 0;
    while (descent.depth > 0) {
        const SidePair pair = top(descent);
        const Side a = sideA(pair);
        const Side b = sideB(pair);
        if (isLeaf(a & b)) {
            if (batch.count == LeafPairBatch::capacity) {
                return DescentEnd::found;
            }
            batch.leafA[batch.count] = leafOf(descent.nodesA, a);
            batch.leafB[batch.count++] = leafOf(descent.nodesB, b);
            --descent.depth;
            continue;
        }
        ++descent.work;
        --descent.depth;
        push(descent, a, b, test(descent, pose, a, b, passed));
    }
    return DescentEnd::exhausted;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

DescentEnd toLeafPairs(Descent& descent, LeafPairBatch& batch, PassedBy& passed) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(toLeafPairs);
    return kernel.chosen()(descent, batch, passed);
}

}  // namespace grapeshot::detail
#endif
