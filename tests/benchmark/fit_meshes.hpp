// The meshes that formulas and tables are fitted on: none of them is reported.
#pragma once

#include <vector>

#include "meshes.hpp"

namespace grapeshot::bench {

/// Generated, 1k to 200k triangles, box diagonal 2; `quick` leaves out those beyond 10k.
[[nodiscard]] std::vector<NamedMesh> fitMeshes(bool quick);

}  // namespace grapeshot::bench
