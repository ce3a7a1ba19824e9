// What the rates of contact regions are worth: watched on the meshes for fitting.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::bench {

/// By the calibration's rows of steps: the rate of a region, and whether there is one; as often as its curve is long.
using SeenRegions = std::array<std::vector<std::pair<float, bool>>, Calibration::regionRows>;

/// Two copies of a mesh, box diagonal 2, in each of the poses; adds to `seen`.
void watchRegions(const Tree& tree, const std::vector<Pose>& poses, const Calibration& calibration, SeenRegions& seen);

}  // namespace grapeshot::bench
