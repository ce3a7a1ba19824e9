#include <grapeshot/adb/detail/descent.hpp>

#include <cstring>
#include <limits>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/adb/detail/descent.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/adb/detail/node_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// What a node pair (or a leaf and a node) came to.
struct Children {
    alignas(64) float margin[16];  ///< of each lane, m
    std::uint32_t mask;            ///< lanes whose boxes touch
    Side a[4], b[4];               ///< lane 4 i + j stands for a[i] and b[j]
};

/// The sides below an inner side, without a branch.
HWY_INLINE void sidesBelow(const Node& node, Side side, Side (&out)[4]) {
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
        const ChildRef child = node.child[slot];
        out[slot] = isLeaf(child) ? (leafBit | side << 2U | slot) : child;
    }
}
HWY_INLINE void sameSide(Side side, Side (&out)[4]) {
    for (Side& entry : out) {
        entry = side;
    }
}

HWY_INLINE void test(const Descent& descent, Side a, Side b, Children& out) {
    if (!isLeaf(a) && !isLeaf(b)) [[likely]] {
        const Node& nodeA = descent.nodesA[a];
        const Node& nodeB = descent.nodesB[b];
        sidesBelow(nodeA, a, out.a);
        sidesBelow(nodeB, b, out.b);
        const Float16 margin = marginsOf(descent.prepared, AllOfA{&nodeA}, AllOfB{&nodeB});
        out.mask = touching(descent.prepared, margin);
        store(margin, out.margin);
    } else if (isLeaf(a)) {
        const OneChild leaf{descent.nodesA + (indexOf(a) >> 2U), a & 3U};
        const Node& nodeB = descent.nodesB[b];
        sameSide(a, out.a);
        sidesBelow(nodeB, b, out.b);
        const Float16 margin = marginsOf(descent.prepared, leaf, AllOfB{&nodeB});
        out.mask = touching(descent.prepared, margin) & 0x000fU;
        store(margin, out.margin);
    } else {
        const OneChild leaf{descent.nodesB + (indexOf(b) >> 2U), b & 3U};
        const Node& nodeA = descent.nodesA[a];
        sidesBelow(nodeA, a, out.a);
        sameSide(b, out.b);
        const Float16 margin = marginsOf(descent.prepared, AllOfA{&nodeA}, leaf);
        out.mask = touching(descent.prepared, margin) & 0x1111U;
        store(margin, out.margin);
    }
}

/// Pushes the touching children, the one with the largest margin last, so that it is taken up next; the others stay in
/// the order of their lanes. Sorting them all costs more in mispredicted branches than it saves in steps.
HWY_INLINE void push(Descent& descent, const Children& children) {
    if (descent.depth + 16 > descent.capacity) [[unlikely]] {
        descent.grow(descent);
    }
    SidePair* pairs = descent.stack + descent.depth;
    std::size_t count = 0;
    std::size_t deepest = 0;
    std::int32_t largest = std::numeric_limits<std::int32_t>::min();
    for (std::uint32_t rest = children.mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        // Floats that are not negative are ordered like their bits; those that are lie within the threshold anyway.
        std::int32_t margin;
        std::memcpy(&margin, children.margin + lane, sizeof(margin));
        pairs[count] = sidePair(children.a[lane >> 2U], children.b[lane & 3U]);
        deepest = margin > largest ? count : deepest;
        largest = margin > largest ? margin : largest;
        ++count;
    }
    if (count != 0) {
        const SidePair last = pairs[count - 1];
        pairs[count - 1] = pairs[deepest];
        pairs[deepest] = last;
        descent.depth += count;
    }
}

DescentEnd toOverlap(Descent& descent, std::uint64_t units) {
    for (; descent.depth > 0; --units) {
        if (units == 0) {
            return DescentEnd::budget;
        }
        ++descent.work;
        const SidePair pair = descent.stack[--descent.depth];
        if (bothLeaves(pair)) {
            const std::uint32_t lanes =
                overlapsLeaves(blockA(descent, pair).corner, blockB(descent, pair).corner, descent.pose);
            if (lanes != 0) {
                descent.found = pair;
                descent.lanes = lanes;
                return DescentEnd::found;
            }
            continue;
        }
        Children children;
        test(descent, sideA(pair), sideB(pair), children);
        push(descent, children);
    }
    return DescentEnd::exhausted;
}

DescentEnd toLeafPair(Descent& descent, std::uint64_t units) {
    while (descent.depth > 0) {
        const SidePair pair = descent.stack[descent.depth - 1];
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
        Children children;
        test(descent, sideA(pair), sideB(pair), children);
        push(descent, children);
    }
    return DescentEnd::exhausted;
}

int touchingChildren(const Descent& descent, SidePair pair, TouchingChild (&children)[16]) {
    Children touched;
    test(descent, sideA(pair), sideB(pair), touched);
    int count = 0;
    for (std::uint32_t rest = touched.mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        children[count].pair = sidePair(touched.a[lane >> 2U], touched.b[lane & 3U]);
        children[count].margin = touched.margin[lane];
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
