// Bodies that meet again and again, each time turned anew: are regions of contact found in the step they appear in?
#pragma once

#include <cstdint>

#include <report/report.hpp>

namespace grapeshot::bench {

/// Two deforming bodies of 100k triangles, `meetings` times four steps: two before they touch, two after. The budget
/// mode, the bound given, against the boxes refitted and traversed, in turn.
void addMeetingRows(std::uint64_t seed, int meetings, report::Report& results);

}  // namespace grapeshot::bench
