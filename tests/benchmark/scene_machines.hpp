// Chains, nested cups, gears, an arch, and a pair at the rate of haptics, against GImpact and hulls.
#pragma once

#include <string_view>

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// @param name one of machineScenes()
void runMachine(std::string_view name, const Options& options, report::Report& results);

/// Two meshes of 20,000 triangles that slide on each other, at 1 kHz.
void runHapticPair(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
