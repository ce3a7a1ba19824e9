// The free parameters of the stochastic papers' experiment, chosen on scenes that are not reported.
#pragma once

#include <report/report.hpp>
#include "options.hpp"
#include "stochastic_published.hpp"

namespace grapeshot::bench {

/// First pairs and moves per step without hierarchy, by the distance to its published row; then the depth of the
/// hierarchy with those. What it says is put into FreeParameters by hand.
[[nodiscard]] report::Report fitStochastic(const Options& options, const PublishedRecall& withoutPublished);

}  // namespace grapeshot::bench
