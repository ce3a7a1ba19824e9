// Which limits of the probability give the most speed for an error: tried on the meshes for fitting.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

/// A row for each gate, with the limits that need the fewest steps for its error; for gates.hpp and DecideSettings.
[[nodiscard]] std::vector<report::Row> scanLimits(const Options& options);

}  // namespace grapeshot::bench
