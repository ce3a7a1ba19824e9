// Soft bodies in Bullet on Grapeshot and on Bullet's own handlers, in the same run.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

/// Throws std::invalid_argument for a scenario that there is not.
[[nodiscard]] report::Report runSoftSuite(const Options& options);

}  // namespace grapeshot::bench
