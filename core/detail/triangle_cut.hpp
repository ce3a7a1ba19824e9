// The segment in which two triangles cut through each other.
//
// This work is based on:
// Tomas Moeller. A Fast Triangle-Triangle Intersection Test. 1997 (intervals on the line of both planes)
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace grapeshot::detail {

using TriangleD = std::array<Eigen::Vector3d, 3>;

/// In double, because the closed curve that the segments make up is integrated.
struct TriangleCut {
    Eigen::Vector3d from, to;  ///< directed along normalA x normalB, m
    /// Bit per corner: behind the other triangle's plane.
    unsigned insideA = 0;
    unsigned insideB = 0;
};

/// Nothing if the triangles do not intersect, only touch, or lie in one plane. A corner exactly in the other's plane
/// counts as outside, for all triangles around it alike, so that the curve of two closed meshes closes.
[[nodiscard]] std::optional<TriangleCut> cut(const TriangleD& a, const TriangleD& b);

}  // namespace grapeshot::detail
