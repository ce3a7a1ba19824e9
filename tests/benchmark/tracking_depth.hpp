// grapeshot_bench tracking --scenario depth: how deep solids are in each other, against every vertex inside.
#pragma once

#include <cstdint>

#include <report/report.hpp>

namespace grapeshot::bench {

/// Two copies of each reported mesh, put into each other by 2, 5 and 10 % of the box diagonal.
void addDepthRows(std::uint64_t seed, bool quick, int poses, report::Report& results);

}  // namespace grapeshot::bench
