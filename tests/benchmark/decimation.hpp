// A mesh with fewer triangles, as game teams make it.
#pragma once

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

/// Edge collapse (meshoptimizer) to about so many triangles, whatever error it takes.
[[nodiscard]] scenes::Mesh decimated(MeshView mesh, std::size_t triangles);

}  // namespace grapeshot::bench
