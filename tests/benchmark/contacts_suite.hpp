// Contact regions against the exact ones, at equal quality against the decimated mesh.
#pragma once

#include <report/report.hpp>

#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runContactsSuite(const Options& options);

}  // namespace grapeshot::bench
