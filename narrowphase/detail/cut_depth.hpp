// How deep two solids are in each other around one cut, and where.
#pragma once

#include <vector>

#include <grapeshot/narrowphase/detail/surface_cut.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot::detail {

/// Columns of the common volume along the cut's normal: from A's vertices inside B to B's surface, from B's inside A to
/// A's, and, if there are none (two crossing bars), through points amid the curve. Vertices are sought from the cut
/// inwards, deepest first, at most 256 of each mesh, and about 16 of each that are `spread` (m) apart are measured.
/// Appended to `out` as contacts with the cut's normal.
void measureColumns(const MeshModel& a, const MeshModel& b, const Pose& bInA, const SurfaceCut& cut,
                    std::span<const CutPiece> pieces, float spread, std::vector<SurfaceContact>& out);

}  // namespace grapeshot::detail
