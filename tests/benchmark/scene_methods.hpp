// The same scenes by each Method: what they cost, what they find, what they keep in memory.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Adds a row per scene and method (adb, scf, automatic; scf with little work, so that it samples), and claims.
void runMethods(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
