// Bullet scenes on Grapeshot and on GImpact, in the same run.
#pragma once

#include "options.hpp"
#include <report/report.hpp>

namespace grapeshot::bench {

[[nodiscard]] report::Report runSceneSuite(const Options& options);

}  // namespace grapeshot::bench
