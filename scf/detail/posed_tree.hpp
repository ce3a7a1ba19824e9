// A ball tree where it is now: balls and leaves are made the first time that a step asks for them.
#pragma once

#include <cstdint>
#include <span>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/detail/ball_kernels.hpp>
#include <grapeshot/scf/detail/pieces_of_step.hpp>

namespace grapeshot::detail {

/// Not for two threads. References hold until the next `begin`.
class PosedTree {
  public:
    explicit PosedTree(const BallTree& tree);
    /// Another tree from the next `begin` on, with the same memory.
    void turnTo(const BallTree& tree) {
        m_tree = &tree;
        m_made.makeRoom(tree.nodes.size(), tree.leaves.size());
    }

    /// A new step. The positions must stay where they are until the next one, as many as the tree has vertices.
    /// @param stretch every edge is at most so many times as long as at rest; not above 0: balls are fitted to the
    /// vertices instead, O(n)
    void begin(std::span<const Eigen::Vector3f> positions, const Pose* pose, float stretch);
    /// The same for vertices that are where they were at rest, but for the pose.
    void beginAtRest(const Pose* pose);

    [[nodiscard]] const BallTree& tree() const { return *m_tree; }
    [[nodiscard]] const BallNode& node(std::uint32_t index) const { return m_tree->nodes[index]; }
    /// Of the children of a node.
    [[nodiscard]] const FourBalls& balls(std::uint32_t node) {
        return m_made.balls(node, [&](FourBalls& balls) { makeBalls(node, balls); });
    }
    /// Puts the ball of a piece by itself, not the root, into a slot.
    void putBall(BallRef ref, FourBalls& balls, int slot) { putBall(ref, m_tree->own(ref), balls, slot); }
    /// The same, if the tree's entry is at hand.
    void putBall(BallRef ref, const PieceBall& own, FourBalls& balls, int slot);
    [[nodiscard]] const PosedLeaf& leaf(std::uint32_t index) {
        return m_made.leaf(index, [&](PosedLeaf& leaf) { makeLeaf(index, leaf); });
    }
    [[nodiscard]] Eigen::Vector3f point(std::uint32_t vertex) const {
        const Eigen::Vector3f& p = m_positions[vertex];
        return m_isPosed ? moved(p) : p;
    }
    /// `point` will soon be asked for it.
    void prefetch(std::uint32_t vertex) const { __builtin_prefetch(&m_positions[vertex]); }
    /// `balls` and `putBall`, or `leaf`, will soon be asked for this piece: what is listed of it.
    void prefetchPiece(BallRef piece) const {
        const std::uint32_t index = ballIndex(piece);
        if (isBallLeaf(piece)) {
            const auto* const lines = reinterpret_cast<const char*>(&m_tree->leaves[index]);
            for (std::size_t i = 0; i < sizeof(BallLeaf); i += 64) {
                __builtin_prefetch(lines + i);
            }
        } else {
            __builtin_prefetch(&m_tree->nodes[index]);
            __builtin_prefetch(&m_tree->nodes[index].child[0]);
            m_made.prefetchBalls(index);
        }
    }
    /// And then the positions that are listed there, if this step has not made the piece yet.
    void prefetchPoints(BallRef piece) const {
        const std::uint32_t index = ballIndex(piece);
        if (!isBallLeaf(piece)) {
            if (m_atRest) {
                __builtin_prefetch(&m_tree->plainBalls[index]);
            } else if (!m_made.hasBalls(index)) {
                const BallNode& node = m_tree->nodes[index];
                for (std::uint32_t slot = 0; slot < node.count; ++slot) {
                    prefetch(node.center[slot]);
                }
            }
        } else if (!m_made.hasLeaf(index)) {
            for (const auto& corners : m_tree->leaves[index].corner) {
                for (const std::uint32_t vertex : corners) {
                    prefetch(vertex);
                }
            }
        }
    }
    /// Are all positions finite that were read for balls and leaves in this step?
    [[nodiscard]] bool isFinite() const { return m_finite; }

  private:
    [[nodiscard]] Eigen::Vector3f moved(const Eigen::Vector3f& p) const;
    void makeBalls(std::uint32_t node, FourBalls& balls);
    void makeLeaf(std::uint32_t index, PosedLeaf& leaf);
    void putPlainBall(const float (&center)[3], float radius, FourBalls& balls, std::uint32_t slot);
    [[nodiscard]] float radiusOf(BallRef child, std::uint32_t center, float restRadius);
    [[nodiscard]] float radiusFromVertices(std::uint32_t leaf, const Eigen::Vector3f& center);
    [[nodiscard]] float radiusFromChildren(std::uint32_t node, const Eigen::Vector3f& center);
    void note(const Eigen::Vector3f& point) {
        const float zero = (point[0] - point[0]) + (point[1] - point[1]) + (point[2] - point[2]);
        m_finite = m_finite && zero == 0;
    }

    const BallTree* m_tree;
    std::span<const Eigen::Vector3f> m_positions;
    bool m_isPosed = false;
    bool m_atRest = false;
    float m_rotation[9] = {}, m_translation[3] = {};
    float m_stretch = 1;
    float m_farthest = 0;  ///< coordinate of the translation, m
    bool m_finite = true;
    PiecesOfStep<FourBalls, PosedLeaf> m_made;
};

}  // namespace grapeshot::detail
