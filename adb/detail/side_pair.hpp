// The pairs that a descent into two trees takes up.
#pragma once

#include <cstdint>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// One side of a pair. Inner: index of the node. Leaf: leafBit | 4 * node + slot of the parent's slot that holds it,
/// because that is where its box is.
using Side = std::uint32_t;

/// A in the upper half.
using SidePair = std::uint64_t;
[[nodiscard]] constexpr SidePair sidePair(Side a, Side b) noexcept {
    return SidePair{a} << 32U | b;
}
[[nodiscard]] constexpr Side sideA(SidePair pair) noexcept {
    return static_cast<Side>(pair >> 32U);
}
[[nodiscard]] constexpr Side sideB(SidePair pair) noexcept {
    return static_cast<Side>(pair);
}
[[nodiscard]] constexpr bool bothLeaves(SidePair pair) noexcept {
    return isLeaf(sideA(pair)) && isLeaf(sideB(pair));
}

/// Index of the leaf block that a leaf side stands for.
[[nodiscard]] inline std::uint32_t leafOf(const Node* nodes, Side side) noexcept {
    return indexOf(nodes[indexOf(side) >> 2U].child[side & 3U]);
}

}  // namespace grapeshot::detail
