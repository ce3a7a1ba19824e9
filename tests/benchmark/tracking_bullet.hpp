// The tracker against the collision part of Bullet's own soft bodies, on the same deforming surfaces.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Two waving bodies of 10,000, 100,000 and a million triangles together: a row for each way of either side, all frame
/// by frame in turns; ratios are to Bullet's update and collision, median, least and most of the repetitions.
void addBulletRows(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
