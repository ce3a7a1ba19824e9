// Collisions found over the age of a region, beside the published table.
#pragma once

#include <string>
#include <vector>

#include "stochastic_published.hpp"
#include "stochastic_recall.hpp"

namespace grapeshot::bench {

/// stochastic_found.png: the published rows in grey; with and without hierarchy, velocity, multires. @throws Error
/// badFile
void drawStochasticPlots(const std::vector<StochasticMethod>& methods, const std::vector<Recall>& recalls,
                         const std::vector<PublishedRecall>& published, const std::string& folder);

}  // namespace grapeshot::bench
