// The experiment of the ADB-tree paper, by its method in adb/reference.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

/// Fits tau, grid and pMin on two shapes, measures error and time per distance on others, and draws both beside the
/// published curves.
[[nodiscard]] report::Report runPaperSuite(const Options& options);

}  // namespace grapeshot::bench
