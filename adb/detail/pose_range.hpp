// Zachmann's range of poses of two bodies, by six numbers from the unit interval.
//
// This work is based on:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002, section 6 (two bodies, a range of centre
// distances, random rotations)
// Ken Shoemake. Uniform Random Rotations. Graphics Gems III, 1992
#pragma once

#include <array>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::detail {

/// Of the mesh's box, m.
[[nodiscard]] Eigen::Vector3d middleOf(const Tree& tree);
/// Of the smallest ball about the middle of the box, m. Looks at every corner of every triangle.
[[nodiscard]] double boundingDiameter(const Tree& tree);
/// Uniform, from numbers in 0..1.
[[nodiscard]] Eigen::Vector3d directionFrom(double u, double v);
[[nodiscard]] Eigen::Matrix3d rotationFrom(double u, double v, double t);

/// Of B in A's frame. Twelve distances of the boxes' middles, from 0.2 to 1.05 of the mean bounding diameter; uniform
/// rotations and directions. A value; looks at every vertex once, when it is made.
class PoseRange {
  public:
    PoseRange(const Tree& a, const Tree& b);
    /// @param unit 0..1 (1 excluded) each: distance, three of the rotation, two of the direction
    [[nodiscard]] Pose at(const std::array<double, 6>& unit) const;

  private:
    Eigen::Matrix<double, 3, 1, Eigen::DontAlign> m_middleA, m_middleB;
    double m_diameter;
};

}  // namespace grapeshot::detail
