// When does a point pass through a triangle, or an edge through an edge, all corners on straight lines? And how near
// are they at one time?
//
// This work is based on:
// Xavier Provot. Collision and Self-Collision Handling in Cloth Model Dedicated to Design Garments. Graphics Interface
// 1997 (the cubic)
// Robert Bridson, Ronald Fedkiw, John Anderson. Robust Treatment of Collisions, Contact and Friction for Cloth
// Animation. SIGGRAPH 2002
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// A point at the begin and at the end of a step.
struct Moving {
    Eigen::Vector3d from, to;
    [[nodiscard]] Eigen::Vector3d at(double time) const { return from + time * (to - from); }
};

struct Crossing {
    double time = 0;                                    ///< 0..1
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of the triangle's corners
    /// Unit, to the side that the point (the first edge) came from, at that time.
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// The earliest crossing of the point and the triangle.
[[nodiscard]] std::optional<Crossing> crossingOf(const Moving& point, const std::array<Moving, 3>& triangle);

struct EdgeCrossing {
    double time = 0;
    double first = 0, second = 0;  ///< where on the edges, 0..1
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// The earliest crossing of two edges.
[[nodiscard]] std::optional<EdgeCrossing> crossingOf(const std::array<Moving, 2>& first,
                                                     const std::array<Moving, 2>& second);

/// Weights of the point of the triangle nearest to `point`.
[[nodiscard]] Eigen::Vector3d nearestOn(const Eigen::Vector3d& point, const std::array<Eigen::Vector3d, 3>& triangle);

/// Where two lines are nearest to each other, if that is inside of both segments; parallel ones: nothing.
[[nodiscard]] std::optional<Eigen::Vector2d> nearestInside(const std::array<Eigen::Vector3d, 2>& first,
                                                           const std::array<Eigen::Vector3d, 2>& second);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
