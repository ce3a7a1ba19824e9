// Charts of the anytime answers: are the probabilities true, and how fast does the error fall.
#pragma once

#include <string>
#include <vector>

#include "forecasts.hpp"

namespace grapeshot::bench {

/// anytime_reliability_SCENARIO.png and anytime_error_SCENARIO.png. The first of the series is ours.
void drawAnytimePlots(const std::vector<Series>& all, const std::string& scenario, const std::string& folder);

}  // namespace grapeshot::bench
