// One pair of triangles in double precision: for the few that single precision cannot decide (touching, coplanar,
// degenerate, edges almost parallel, extents beyond its range).
#pragma once

#include <Eigen/Core>

namespace grapeshot::detail {

/// Corners of one triangle, the values the wide kernel was given.
struct HardTriangle {
    Eigen::Vector3d corner[3];
};

/// The closed triangles share a point. Wrong only where gap or depth is below about 1e-12 of the extent; two triangles
/// that are both degenerate overlap if they are closer than 1e-9 of it.
[[nodiscard]] bool hardOverlap(const HardTriangle& first, const HardTriangle& second) noexcept;

/// What `signedDistances` says of an overlapping pair.
struct HardDepth {
    double depth = 0;  ///< smallest translation that parts them, >= 0
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    int featureA = 6;
    int featureB = 6;
};

/// Only for pairs that overlap.
[[nodiscard]] HardDepth hardDepth(const HardTriangle& first, const HardTriangle& second) noexcept;

}  // namespace grapeshot::detail
