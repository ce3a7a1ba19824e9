// The slow truth of depths: which vertices are inside the other solid, how far from its surface, and which of them hang
// together over the curves in which the surfaces cut each other. In double precision, by solid angles and all
// triangles.
//
// This work is based on:
// Adriaan Van Oosterom, Jan Strackee. The Solid Angle of a Plane Triangle. IEEE Trans. Biomed. Eng. 30, 1983
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/core/triangle_pair.hpp>

namespace grapeshot::test {

/// Is the point inside? The sum of the solid angles over 4 pi is then not 0.
bool isInside(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles,
              const Eigen::Vector3d& point);
/// m
double distanceTo(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles,
                  const Eigen::Vector3d& point);

/// One of its vertices is behind the other's surface by `depth`; none is deeper. Of a region without vertices (edges
/// that cross) 0.
struct TrueRegion {
    double depth = 0;                             ///< m
    std::vector<std::uint32_t> insideA, insideB;  ///< vertices, ascending; the lowest of those at one place
    std::vector<TrianglePair> cuts;
};

/// @param cuts the pairs of triangles that overlap
std::vector<TrueRegion> trueRegions(MeshView a, MeshView b, const Pose& bInA, std::span<const TrianglePair> cuts);

/// The same for large meshes: which vertices are inside and how far from the surface is what `adb` says of points, in
/// double precision.
std::vector<TrueRegion> trueRegions(const Tree& a, const Tree& b, const Pose& bInA, std::span<const TrianglePair> cuts);

}  // namespace grapeshot::test
