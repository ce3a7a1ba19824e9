// Steps of Lin-Canny from pose to pose, from the last features and from anywhere.
#pragma once

#include <report/report.hpp>

namespace grapeshot::bench {

/// Two balls of 320 to 20,480 faces that circle each other, by 0.1, 1 and 10 degrees a pose.
void addConvexRows(bool quick, report::Report& results);

}  // namespace grapeshot::bench
