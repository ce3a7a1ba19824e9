// Bullet scenes on Grapeshot and on GImpact, in the same run.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runSceneSuite(const Options& options);

}  // namespace grapeshot::bench
