// Triangles sorted into ever smaller groups, two at a time.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// A group of triangles, [begin, end) of BinaryTree::order, and the two it is made of, which stand after it; or a leaf.
struct BinaryNode {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t left = 0;  ///< 0 for a leaf
    std::uint32_t right = 0;
    double reach = 0;  ///< how likely a partner meets its box, up to a common factor
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct BinaryTree {
    std::vector<BinaryNode> nodes;     ///< the root first
    std::vector<std::uint32_t> order;  ///< triangle indices
};

/// Down to groups of at most settings.maxLeafTriangles. Reads only `tree.vertices` and `tree.triangles`. At most 64 +
/// 28 levels deep, whatever the mesh.
[[nodiscard]] BinaryTree sortInTwos(const Tree& tree, const BuildSettings& settings);

}  // namespace grapeshot::detail
