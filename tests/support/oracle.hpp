// The slow truth: every triangle pair, in double precision, by other formulas than the library's.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::test {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Distance of two closed triangles, 0 if they share a point. Minimum over vertex-face, edge-edge and
/// edge-through-face.
double triangleDistance(const Corners& a, const Corners& b);
/// Do they share a point? Sign of orientation determinants in long double; coplanar pairs by edge crossings and
/// containment.
bool trianglesOverlap(const Corners& a, const Corners& b);
/// By how much must the pair be parted (if overlapping), or how far apart is it: |value| small = borderline. m
double triangleSeparation(const Corners& a, const Corners& b);

/// Corners of triangle t, moved by the pose in double precision.
Corners cornersOf(MeshView mesh, std::uint32_t t, const Pose& pose = {});

/// Does any pair overlap?
bool bruteForceDecide(MeshView a, MeshView b, const Pose& bInA);
/// All pairs with distance <= maxDistance, ascending (a, b).
std::vector<TrianglePair> bruteForcePairs(MeshView a, MeshView b, const Pose& bInA, double maxDistance);
/// The smallest distance over all pairs, and for colliding meshes minus the largest separation needed by a single
/// overlapping pair: how far from the border the pose is.
double bruteForceClearance(MeshView a, MeshView b, const Pose& bInA);

}  // namespace grapeshot::test
