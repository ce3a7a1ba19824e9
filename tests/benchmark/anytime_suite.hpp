// Estimates that are stopped after so many steps: how often wrong, how well calibrated, and whether anything else says
// more after as many.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runAnytimeSuite(const Options& options);

}  // namespace grapeshot::bench
