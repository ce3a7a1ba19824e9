// The descent into two trees at once: a stack of node pairs, taken up nearest first.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <grapeshot/adb/detail/pair_pose.hpp>
#include <grapeshot/adb/detail/side_pair.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// Where a descent is: everything that the kernels read and write. Plain data.
struct Descent {
    PairPose prepared;
    Pose pose;
    const Node* nodesA = nullptr;
    const Node* nodesB = nullptr;
    const NodeDistribution* distributionsA = nullptr;
    const NodeDistribution* distributionsB = nullptr;
    const LeafBlock* leavesA = nullptr;
    const LeafBlock* leavesB = nullptr;
    Side* stackA = nullptr;  ///< the pairs still to be taken up, the next one last: A's and B's sides
    Side* stackB = nullptr;
    std::size_t depth = 0;
    std::size_t capacity = 0;           ///< of both, at least stackRoom more than `depth`
    float stepRates[4] = {1, 1, 1, 1};  ///< of both trees: see Tree
    void (*grow)(Descent&) = nullptr;   ///< makes the capacity larger
    void* owner = nullptr;              ///< for `grow`
    std::uint64_t work = 0;             ///< units spent
    SidePair found = 0;                 ///< the leaf pair that a descent ended at
    std::uint32_t lanes = 0;            ///< of `found`: which triangle pairs overlap, lane = 4 a + b
};

/// What a step writes beyond the top of the stack, at most.
inline constexpr std::size_t stackRoom = 40;

inline void push(Descent& descent, SidePair pair) noexcept {
    descent.stackA[descent.depth] = sideA(pair);
    descent.stackB[descent.depth++] = sideB(pair);
    if (descent.depth + stackRoom > descent.capacity) {
        descent.grow(descent);
    }
}

/// The trees to descend into; they must stay where they are.
inline void setTrees(Descent& descent, const Tree& a, const Tree& b) noexcept {
    descent.nodesA = a.nodes.data();
    descent.nodesB = b.nodes.data();
    descent.distributionsA = a.distributions.data();
    descent.distributionsB = b.distributions.data();
    descent.leavesA = a.leaves.data();
    descent.leavesB = b.leaves.data();
    for (std::size_t i = 0; i < a.stepRates.size(); ++i) {
        descent.stepRates[i] = std::sqrt(a.stepRates[i] * b.stepRates[i]);
    }
}

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
