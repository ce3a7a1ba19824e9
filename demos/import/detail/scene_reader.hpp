// A file into a mesh by assimp, in the process that may crash.
#pragma once

#include <cstddef>
#include <string>
#include <variant>

#include "wire.hpp"

namespace grapeshot::import::detail {

/// All triangles of all nodes, in the root's frame.
[[nodiscard]] std::variant<scenes::Mesh, WireError> readScene(const std::string& file, std::size_t maxVertices,
                                                              std::size_t maxTriangles);

}  // namespace grapeshot::import::detail
