// Which kept candidates can give a contact now, before the triangle kernels have to say so.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

/// The pairs whose boxes are within `maxDistance` now and whose surfaces face each other or cut through each other, in
/// their order. Never leaves out one that has a local contact or overlapping triangles. Whether surfaces that do not
/// face each other cross is asked of the overlap kernel where the boxes overlap: returns its calls, a work unit each,
/// at most `mostWork`, beyond which such pairs stay in. `out` is overwritten and its memory kept.
std::uint64_t nearPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const LeafPair> pairs,
                        float maxDistance, std::uint64_t mostWork, std::vector<LeafPair>& out);

}  // namespace grapeshot::detail
