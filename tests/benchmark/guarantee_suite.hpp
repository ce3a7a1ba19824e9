// Does the promise hold? Certificates on fresh poses of unseen meshes; the audit on bodies at rest and grazing.
#pragma once

#include <report/report.hpp>
#include "options.hpp"

namespace grapeshot::bench {

[[nodiscard]] report::Report runGuaranteeSuite(const Options& options);

}  // namespace grapeshot::bench
