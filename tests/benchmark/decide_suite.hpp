// Yes or no of two copies of a mesh: exact, estimated, and both at once, against FCL and other engines, and against
// what else could be done with as little time.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runDecideSuite(const Options& options);

}  // namespace grapeshot::bench
