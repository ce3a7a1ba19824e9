// Bodies that meet again and again, each time turned anew: are regions of contact found in the step they appear in?
#pragma once

#include <cstdint>

#include <string>

#include <report/report.hpp>

#include "tracking_scenes.hpp"

namespace grapeshot::bench {

struct MeetingSpec {
    std::string name;
    int frequency;  ///< of the spheres: 20 frequency^2 triangles each
    int meetings;
    TrackingBudget budget;
};

struct MeetingResult {
    double mismatches = 0;   ///< steps whose exact pairs are not those of the boxes
    double newFound = 0;     ///< share of the regions that are new in the step
    double allFound = 0;     ///< of all
    double timesFaster = 0;  ///< than the boxes
};

/// Two deforming bodies, `meetings` times four steps: two before they touch, two after. The budget mode, the bound
/// given, against the boxes refitted and traversed, in turn.
MeetingResult addMeetingRows(const MeetingSpec& spec, std::uint64_t seed, report::Report& results);

}  // namespace grapeshot::bench
