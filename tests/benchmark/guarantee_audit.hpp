// The audit on motions for which nobody has certified anything.
#pragma once

#include <vector>

#include <report/report.hpp>
#include "meshes.hpp"
#include "options.hpp"

namespace grapeshot::bench {

enum class Motion {
    resting,  ///< pairs that touch and tremble: each frame depends on the one before
    grazing   ///< pairs that slowly go in and out of each other's surface while they turn
};
[[nodiscard]] const char* name(Motion motion) noexcept;

/// 1,000 runs of scenes of twenty pairs, each with its own coins, answered with what is certified on Zachmann's poses
/// (which these are not) and with the default settings, and a long run of each. Appends a row per mesh and settings,
/// and the claims: in how many of the runs both bounds held at all times; the share of work for re-checks.
void auditRuns(Motion motion, const Options& options, const std::vector<NamedMesh>& meshes, report::Report& results);

}  // namespace grapeshot::bench
