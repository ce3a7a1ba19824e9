// A mesh of a million triangles appears under bodies that fall, and no tree of it is there.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Steps until contacts are those of the mesh itself, with a budget of a millisecond each (5,000 units): what they cost
/// in units and in processor time, and how deep the bodies sink in meanwhile.
void runAppear(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
