// Vertices of one surface that are too near to each other along it to collide.
#pragma once

#include <grapeshot/scf/surface.hpp>

namespace grapeshot {

/// Per vertex, ascending: those with a way along edges of at most `distance` (m, at rest), and its neighbours. A sheet
/// that is folded at rest has far ways between its layers. By Dijkstra's algorithm from each vertex: O(vertices times
/// what is near).
[[nodiscard]] IndexLists nearVertices(const Surface& surface, float distance);

}  // namespace grapeshot
