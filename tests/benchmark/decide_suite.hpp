// Exact yes/no of two copies of a mesh, against FCL, on Zachmann's procedure.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runDecideSuite(const Options& options);

}  // namespace grapeshot::bench
