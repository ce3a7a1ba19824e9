// grapeshot_bench continuous: first impacts in a step, against roots of cubics, substeps and FCL.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runContinuousSuite(const Options& options);

}  // namespace grapeshot::bench
