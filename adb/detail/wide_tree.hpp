// From groups of two to the four-wide tree: who is together under one node.
#pragma once

#include <grapeshot/adb/detail/binary_tree.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// The mesh, copied.
/// @throws Error as requireUsable does, and tooLarge beyond 2^28 triangles
Sliced copyMeshInSlices(MeshView mesh, Tree& tree);
[[nodiscard]] Tree treeWithoutNodes(MeshView mesh);

/// The cheapest four-wide tree whose nodes are groups of `binary`, with all that its nodes say. No leaf of `binary` may
/// have more than four triangles.
Sliced addNodesInSlices(const BinaryTree& binary, Tree& tree);
void addNodes(const BinaryTree& binary, Tree& tree);

}  // namespace grapeshot::detail
