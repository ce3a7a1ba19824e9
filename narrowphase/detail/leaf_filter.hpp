// Which kept candidates are still near, before the triangle kernel has to say so.
#pragma once

#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>

namespace grapeshot::detail {

/// The pairs whose boxes are within `maxDistance` now, in their order; never leaves out one that has triangles within
/// it. `out` is overwritten and its memory kept.
void nearPairs(const Tree& a, const Tree& b, const Pose& bInA, std::span<const LeafPair> pairs, float maxDistance,
               std::vector<LeafPair>& out);

}  // namespace grapeshot::detail
