// The descent into two trees at once: a stack of node pairs, taken up nearest first.
#pragma once

#include <cstddef>
#include <cstdint>

#include <grapeshot/adb/detail/pair_pose.hpp>
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

/// Where a descent is: everything that the kernels read and write. Plain data.
struct Descent {
    PairPose prepared;
    Pose pose;
    const Node* nodesA = nullptr;
    const Node* nodesB = nullptr;
    const LeafBlock* leavesA = nullptr;
    const LeafBlock* leavesB = nullptr;
    SidePair* stack = nullptr;  ///< room for at least 16 more entries than `depth`
    std::size_t depth = 0;
    std::size_t capacity = 0;
    void (*grow)(Descent&) = nullptr;  ///< makes the capacity larger
    void* owner = nullptr;             ///< for `grow`
    std::uint64_t work = 0;            ///< units spent
    SidePair found = 0;                ///< the leaf pair that a descent ended at
    std::uint32_t lanes = 0;           ///< of `found`: which triangle pairs overlap, lane = 4 a + b
};

[[nodiscard]] inline const LeafBlock& blockA(const Descent& descent, SidePair leaves) noexcept {
    return descent.leavesA[leafOf(descent.nodesA, sideA(leaves))];
}
[[nodiscard]] inline const LeafBlock& blockB(const Descent& descent, SidePair leaves) noexcept {
    return descent.leavesB[leafOf(descent.nodesB, sideB(leaves))];
}

enum class DescentEnd {
    exhausted,  ///< nothing is left
    found,      ///< at `found`, which is off the stack
    budget,
};

/// To the first leaf pair with overlapping triangles, spending at most `units`.
DescentEnd toOverlap(Descent& descent, std::uint64_t units) noexcept;

/// To the next leaf pair whose boxes touch. Finding it costs no unit by itself.
DescentEnd toLeafPair(Descent& descent, std::uint64_t units) noexcept;

struct TouchingChild {
    SidePair pair;
    float margin;  ///< m
};
/// The touching children of a pair that is not a pair of leaves, in the order of the lanes. One unit, not counted here.
int touchingChildren(const Descent& descent, SidePair pair, TouchingChild (&children)[16]) noexcept;

}  // namespace grapeshot::detail
