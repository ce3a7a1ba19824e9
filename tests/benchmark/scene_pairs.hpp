// What one pair of rigid bodies costs in a step, by method: touching, and near each other.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Adds a row for each, and one for the tracker's features alone.
void measurePairs(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
