// How deep two solids are in each other around a contact region, measured: what estimated depths are compared with.
#pragma once

#include <vector>

#include <grapeshot/narrowphase/mesh_model.hpp>

#include "region_scoring.hpp"

namespace grapeshot::bench {

/// Of each region the deepest column of the common volume along the normal of the cut that the region lies on
/// (narrowphase/detail/cut_depth.hpp), m; 0 where no cut is near and faces the same way.
[[nodiscard]] std::vector<float> measuredDepths(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                                                const Regions& regions, const RegionSettings& settings);

}  // namespace grapeshot::bench
