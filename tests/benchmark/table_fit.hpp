// A row of the calibration table: how often a rate turned out to be a collision.
#pragma once

#include <utility>
#include <vector>

#include <grapeshot/adb/calibration.hpp>

namespace grapeshot::bench {

/// The monotone curve nearest to what was seen, at the knots of the table.
/// @param seen rates > 0 and whether the meshes did collide; at least one
[[nodiscard]] Calibration::Row fitRow(std::vector<std::pair<float, bool>> seen);

}  // namespace grapeshot::bench
