// Rotations from an axis and an angle, and back, in double precision.
#pragma once

#include <Eigen/Core>

namespace grapeshot::detail {

/// By halving and doubling angles, with square roots and a short series alone: the last bits of a library's sine depend
/// on the machine. Any angle; some 20 ns.
/// @param axisAngle axis times angle, rad
[[nodiscard]] Eigen::Matrix3d rotationBy(const Eigen::Vector3d& axisAngle);

/// The other way round, at most half a turn. @param rotation orthonormal up to rounding
[[nodiscard]] Eigen::Vector3d axisAngleOf(const Eigen::Matrix3d& rotation);

}  // namespace grapeshot::detail
