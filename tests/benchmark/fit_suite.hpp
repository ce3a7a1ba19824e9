// Fits the rate formula and its calibration table.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

/// On meshes that no other suite reports. Writes the calibration to `options.outputFile` if there is one.
[[nodiscard]] report::Report runFitSuite(const Options& options);

}  // namespace grapeshot::bench
