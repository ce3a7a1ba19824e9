// A ball tree in motion: balls on straight paths that hold all that is in them at every moment of a part of the step.
//
// Between its ends a piece lies in the ball between its balls there: straight lines are convex, and turning changes no
// distance from the centre. Where the frame turns, the centre's path is bent; it is nowhere farther from its chord than
// an eighth of its largest acceleration, by which the ball grows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/scf/detail/posed_tree.hpp>
#include <grapeshot/scf/detail/sweep_kernels.hpp>
#include <grapeshot/scf/motion.hpp>

namespace grapeshot::detail {

/// A part of a step: the `index`-th of `count` of the same length. Time within it goes from 0 to 1.
struct StepPart {
    int index = 0;
    int count = 1;
};

/// Of a triangle at a moment, in the common frame.
struct MovingCorners {
    Eigen::Vector3d place[3];     ///< m
    Eigen::Vector3d velocity[3];  ///< m per part
};

/// Not for two threads. References hold until the next `begin`.
class MovingTree {
  public:
    explicit MovingTree(const BallTree& tree);

    /// The motion's spans must stay where they are until the next step. A surface that deforms costs O(n) in each part
    /// of a step that has several, whether it is this body that turns or the other; one whose balls are fitted
    /// likewise.
    /// @param stretch as PosedTree::begin
    /// @param part parts follow each other from the first on, with the same motion: asserted of their indices
    void begin(const SurfaceMotion& motion, float stretch, const StepPart& part);

    [[nodiscard]] const BallTree& tree() const { return m_before.tree(); }
    [[nodiscard]] const BallNode& node(std::uint32_t index) const { return tree().nodes[index]; }
    /// Of the children of a node.
    [[nodiscard]] const SweptBalls& balls(std::uint32_t node) {
        return m_made.balls(node, [&](SweptBalls& balls) { makeBalls(node, balls); });
    }
    void putBall(BallRef ref, SweptBalls& balls, int slot);
    [[nodiscard]] const SweptLeaf& leaf(std::uint32_t index) {
        return m_made.leaf(index, [&](SweptLeaf& leaf) { makeLeaf(index, leaf); });
    }

    [[nodiscard]] bool turns() const { return m_turns; }
    /// Corners of a leaf's triangles at both ends of the part.
    [[nodiscard]] const PosedLeaf& leafBefore(std::uint32_t index) { return m_before.leaf(index); }
    [[nodiscard]] const PosedLeaf& leafNow(std::uint32_t index) { return m_now.leaf(index); }
    [[nodiscard]] MovingCorners cornersAt(std::uint32_t triangle, double time) const;
    /// Bound for all corners of a triangle in all of the part, m per part^2.
    [[nodiscard]] double accelerationOf(std::uint32_t triangle) const;
    /// Are all positions finite that were read in this part?
    [[nodiscard]] bool isFinite() const { return m_before.isFinite() && m_now.isFinite(); }

  private:
    void makeBalls(std::uint32_t node, SweptBalls& balls);
    void makeLeaf(std::uint32_t index, SweptLeaf& leaf);
    /// How far the path of a vertex is from its chord, at most; m.
    [[nodiscard]] float bulge(std::uint32_t vertex) const;
    /// Bound on the acceleration of a vertex, m per part^2.
    [[nodiscard]] double acceleration(std::uint32_t vertex) const;
    [[nodiscard]] const Eigen::Vector3f& localBefore(std::uint32_t vertex) const { return m_localBefore[vertex]; }
    [[nodiscard]] const Eigen::Vector3f& localNow(std::uint32_t vertex) const { return m_localNow[vertex]; }

    PosedTree m_before, m_now;
    std::vector<Eigen::Vector3f> m_partBefore, m_partNow;  ///< only if it deforms, in several parts
    std::span<const Eigen::Vector3f> m_localBefore, m_localNow;
    RigidMotion m_frame;
    StepPart m_part;
    double m_angle = 0;  ///< rad per part
    bool m_turns = false;
    PiecesOfStep<SweptBalls, SweptLeaf> m_made;
};

}  // namespace grapeshot::detail
