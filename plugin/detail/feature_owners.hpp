// Each corner and each edge of a mesh is one triangle's to test, so that pairs of triangles test no pair of features
// twice.
//
// This work is based on:
// Sean Curtis, Rasmus Tamstorf, Dinesh Manocha. Fast Collision Detection for Deformable Models using
// Representative-Triangles. I3D 2008
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Per triangle: bit i, it owns corner i; bit 3 + i, it owns the edge from corner i to the next.
using FeatureOwners = std::vector<std::uint8_t>;

/// The lowest triangle owns. O(n log n).
[[nodiscard]] FeatureOwners ownersOf(std::span<const Triangle> triangles, std::size_t vertices);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
