// Piles: how fast, how deep, how soon at rest, against GImpact, hulls and compounds of hulls.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// The gate: 50 bodies of 5,000 triangles on a mesh floor.
void runPile(const Options& options, report::Report& results);

/// Other numbers of bodies and triangles, another floor.
void runBoxFloorPile(const Options& options, report::Report& results);
void runSmallPile(const Options& options, report::Report& results);
void runCoarsePile(const Options& options, report::Report& results);
void runLargePile(const Options& options, report::Report& results);

}  // namespace grapeshot::bench
