// Do two triangles share a point?
//
// This work is based on:
// Stefan Gottschalk. Separating axis theorem. TR96-024, UNC Chapel Hill. 1996
#pragma once

#include <Eigen/Core>
#include <array>

namespace grapeshot::reference {

/// Closed triangles in one frame, double precision. The axes are both normals, the nine products of edges and, for
/// coplanar pairs and triangles without area, what parts segments and points. What it calls apart is apart by more than
/// rounding.
[[nodiscard]] bool trianglesOverlap(const std::array<Eigen::Vector3d, 3>& cornersA,
                                    const std::array<Eigen::Vector3d, 3>& cornersB);

}  // namespace grapeshot::reference
