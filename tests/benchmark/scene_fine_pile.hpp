// A pile of fine meshes for few steps, all methods from where ours brought it.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// 50 bodies of 20,000 triangles on a mesh floor, against GImpact.
void runFinePile(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
