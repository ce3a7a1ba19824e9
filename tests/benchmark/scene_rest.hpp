// Non-convex bodies at rest on, in and around each other, sleeping and damping off: how much do they still move?
#pragma once

#include <report/report.hpp>
#include <support/rest_scenes.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// At both margins, against GImpact.
void runRest(test::RestScene scene, const Options& options, report::Report& results);

}  // namespace grapeshot::bench
