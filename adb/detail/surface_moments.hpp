// Area, mean, covariance and normal of a piece of surface; pieces add up.
#pragma once

#include <Eigen/Core>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// In double, so that the sum over a million triangles is as good as its parts.
struct SurfaceMoments {
    double area = 0;                                       ///< m^2
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();        ///< m
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< about the mean, m^2
    Eigen::Vector3d normalSum = Eigen::Vector3d::Zero();   ///< m^2
};

[[nodiscard]] SurfaceMoments momentsOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// Of the union. Pieces without any area count alike, so that the mean stays among them.
[[nodiscard]] SurfaceMoments sum(const SurfaceMoments* pieces, int count);

/// Of the trace, added to each variance: the covariance of a flat piece can be inverted, in single precision too.
inline constexpr double thickening = 0.005;

/// Writes one child of a node, whose box is there already.
void store(const SurfaceMoments& moments, const Node& node, int slot, NodeDistribution& out);
/// Of a whole mesh with this half diagonal, m.
void storeWhole(const SurfaceMoments& moments, double halfDiagonal, WholeSurface& out);
void storeNone(int slot, NodeDistribution& out);

}  // namespace grapeshot::detail
