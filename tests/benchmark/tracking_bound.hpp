// Are the bounds on what a tracker has missed true?
#pragma once

#include <cstdint>

#include <report/report.hpp>

namespace grapeshot::bench {

/// Steps of two small bodies in motion under a short budget, against the exact contact cells of each: how often the 95
/// % bound holds, its width, the bias of the estimate, wrong certificates. Blocks of 100 steps are the units. With an
/// ample budget, where nearly every step is certain, ten times as many.
void addBoundRows(std::uint64_t seed, int frames, report::Report& results);

}  // namespace grapeshot::bench
