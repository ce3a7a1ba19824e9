// The meshes on which the guarantee is tested: of other parameters and seeds than those that the calibration was fitted
// on and those that the other suites report.
#pragma once

#include <vector>

#include "meshes.hpp"

namespace grapeshot::bench {

/// Generated, 3k to 70k triangles, box diagonal 2; `quick` leaves out those beyond 15k.
[[nodiscard]] std::vector<NamedMesh> guaranteeMeshes(bool quick);

}  // namespace grapeshot::bench
