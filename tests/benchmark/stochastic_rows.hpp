// Recall over several scenes, as rows.
#pragma once

#include <vector>

#include <report/report.hpp>
#include "stochastic_recall.hpp"

namespace grapeshot::bench {

/// Adds a row per scene and method, and one per method for all scenes together, in which every region counts the same;
/// returns those. Intervals are Clopper's and Pearson's at 95 %, as if regions were independent.
[[nodiscard]] std::vector<Recall> measureScenes(const std::vector<ApproachScene>& scenes,
                                                const std::vector<StochasticMethod>& methods, int episodes,
                                                std::uint64_t seed, report::Report& results);

}  // namespace grapeshot::bench
