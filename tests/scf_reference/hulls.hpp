// Convex meshes of random points.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include <scenes/shapes.hpp>

namespace grapeshot::test {

/// Hull of `points` random points on the ellipsoid with these half axes, m: all of them are corners. Point by point,
/// by orientation in double precision; points >= 4.
[[nodiscard]] scenes::Mesh randomHull(int points, const Eigen::Vector3f& half, std::uint64_t seed);

/// A prism over a regular polygon, along y.
[[nodiscard]] scenes::Mesh prism(int sides, float radius, float halfHeight);

}  // namespace grapeshot::test
