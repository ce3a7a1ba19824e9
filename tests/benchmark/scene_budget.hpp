// Quality over the budget of a step: ours, and what else could be done with as much work.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// The pile of 50 bodies of 5,000 triangles from several starts; full work, then shares of it down to a twentieth;
/// decimated proxies, the halved rate of physics and plain round robin at equal work per second.
void runBudget(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
