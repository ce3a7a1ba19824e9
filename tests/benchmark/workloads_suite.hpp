// `grapeshot_bench workloads`: decisions as `decide` does not ask for them.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

/// Errors, work and times are reported; claimed is only what must hold of the exact answers.
/// @throws std::invalid_argument of a scenario that there is none of
[[nodiscard]] report::Report runWorkloadsSuite(const Options& options);

}  // namespace grapeshot::bench
