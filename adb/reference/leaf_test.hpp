// The triangles of two leaves against each other.
#pragma once

#include <cstddef>

#include <grapeshot/adb/reference/placement.hpp>
#include <grapeshot/adb/reference/tree.hpp>

namespace grapeshot::reference {

/// Does any pair overlap? Adds the pairs looked at to `tests`.
[[nodiscard]] bool leavesOverlap(const Hierarchy& a, const TreeNode& leafA, const Hierarchy& b, const TreeNode& leafB,
                                 const Placement& placement, std::size_t& tests);

}  // namespace grapeshot::reference
