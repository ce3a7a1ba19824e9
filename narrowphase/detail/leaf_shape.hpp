// What a leaf block looks like from outside: its box, and where its surroundings face.
//
// This work is based on:
// David Johnson, Elaine Cohen. Spatialized Normal Cone Hierarchies. I3D 2001 (local minima of the distance need normals
// that face each other)
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// By leaf block. The cone holds the normals of the leaf's triangles and of all that share a corner with one, so that
/// it holds the directions in which any of the leaf's corners, edges and faces can be touched, with some to spare.
/// Needs all of the model's derived parts but `leafOf`.
Sliced leafShapesInSlices(MeshModel& model);

/// Added to each leaf's spread, rad: for the leans of contacts on both sides, and what a corner's supporting directions
/// can stick out of the cone of its faces' normals.
inline constexpr float leafSpare = 0.2F;

/// What a line between edges can lean beyond the arc of their normals: nearly parallel faces lend their normal, and at
/// sharp edges they lean as corners do (feature_filter.hpp).
inline constexpr float edgeSpare = 0.03F;
inline constexpr float sharpEdgeSpare = usualLean + 0.05F;

/// What two leaves' spare lacks for a larger lean: corners need coneWidening(lean), edges lean on both sides.
[[nodiscard]] inline NormalCone moreSpread(float lean) {
    const float lacking = std::max(0.0F, coneWidening(lean) - 2 * leafSpare);
    return {std::cos(lacking), std::sin(lacking)};
}

}  // namespace grapeshot::detail
