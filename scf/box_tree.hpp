// Boxes along the axes of a frame for the pieces of a ball tree, as its vertices stand or move: sixteen triangles to a
// leaf, four pieces to a node.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {

/// Along the axes, m; holds nothing by default.
struct PlainBox {
    Eigen::Vector3f low = Eigen::Vector3f::Constant(3e38F), high = Eigen::Vector3f::Constant(-3e38F);
    void add(const Eigen::Vector3f& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    void add(const PlainBox& other) {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
    void grow(float by) {
        low.array() -= by;
        high.array() += by;
    }
    [[nodiscard]] bool meets(const PlainBox& other) const {
        return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
    }
};

/// n of them, coordinate by coordinate.
template <int n>
struct alignas(16) Boxes {
    float low[3][n], high[3][n];

    void set(int k, const PlainBox& box) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis][k] = box.low[axis];
            high[axis][k] = box.high[axis];
        }
    }
    [[nodiscard]] PlainBox at(int k) const {
        return {{low[0][k], low[1][k], low[2][k]}, {high[0][k], high[1][k], high[2][k]}};
    }
    /// Bit per box that meets the given one.
    [[nodiscard]] std::uint32_t meeting(const PlainBox& box) const {
        std::int32_t meets[n];
        for (int k = 0; k < n; ++k) {
            meets[k] = static_cast<std::int32_t>(low[0][k] <= box.high[0]) &
                       static_cast<std::int32_t>(box.low[0] <= high[0][k]) &
                       static_cast<std::int32_t>(low[1][k] <= box.high[1]) &
                       static_cast<std::int32_t>(box.low[1] <= high[1][k]) &
                       static_cast<std::int32_t>(low[2][k] <= box.high[2]) &
                       static_cast<std::int32_t>(box.low[2] <= high[2][k]);
        }
        std::uint32_t bits = 0;
        for (int k = 0; k < n; ++k) {
            bits |= static_cast<std::uint32_t>(meets[k]) << static_cast<unsigned>(k);
        }
        return bits;
    }
};

/// Of the triangles of a leaf, each by `boxOf(lane)`; returns the box of all. Unused lanes repeat the first.
template <class BoxOf>
PlainBox boxTriangles(const BallLeaf& leaf, Boxes<16>& boxes, const BoxOf& boxOf) {
    PlainBox whole;
    for (int k = 0; k < 16; ++k) {
        const PlainBox box = k < static_cast<int>(leaf.count) ? boxOf(k) : boxes.at(0);
        boxes.set(k, box);
        whole.add(box);
    }
    return whole;
}

/// Refers to the ball tree, which must stay where it is. `reset`, then `set` for every leaf, then `refit`.
class BoxTree {
  public:
    void reset(const BallTree& tree);
    /// The triangles' boxes of one leaf, and how much larger nodes take it for.
    void set(std::uint32_t leaf, const Boxes<16>& boxes, const PlainBox& whole, float reach);
    /// The nodes' boxes, after `set`. O(leaves).
    void refit();

    [[nodiscard]] const Boxes<16>& boxes(std::uint32_t leaf) const { return m_boxes[leaf]; }
    [[nodiscard]] const PlainBox& whole(std::uint32_t leaf) const { return m_leaves[leaf]; }
    [[nodiscard]] float reach(std::uint32_t leaf) const { return m_reach[leaf]; }

    /// Calls `visit` with each leaf whose box and reach meet the box. Returns the nodes that were looked at.
    template <class Visit>
    std::uint64_t visitMeeting(const PlainBox& box, const Visit& visit) {
        std::uint64_t looks = 0;
        m_stack.assign(1, 0);
        while (!m_stack.empty()) {
            const std::uint32_t at = m_stack.back();
            m_stack.pop_back();
            ++looks;
            for (std::uint32_t bits = m_nodes[at].meeting(box); bits != 0; bits &= bits - 1) {
                const BallRef child = m_tree->nodes[at].child[__builtin_ctz(bits)];
                if (isBallLeaf(child)) {
                    visit(ballIndex(child));
                } else {
                    m_stack.push_back(child);
                }
            }
        }
        return looks;
    }

  private:
    const BallTree* m_tree = nullptr;
    std::vector<Boxes<16>> m_boxes;
    std::vector<PlainBox> m_leaves;
    std::vector<float> m_reach;  // m
    std::vector<Boxes<4>> m_nodes;
    std::vector<std::uint32_t> m_stack;
};

}  // namespace grapeshot
