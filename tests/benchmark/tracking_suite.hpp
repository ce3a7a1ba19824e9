// grapeshot_bench tracking: deforming surfaces in contact, tracked, against boxes that are fitted in every frame.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runTrackingSuite(const Options& options);

}  // namespace grapeshot::bench
