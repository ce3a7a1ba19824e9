// Triangles sorted into ever smaller groups, two at a time.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// A group of triangles, [begin, end) of BinaryTree::order, and the two it is made of, which stand after it; or a leaf.
struct BinaryNode {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t left = 0;  ///< 0 for a leaf
    std::uint32_t right = 0;
    double reach = 0;         ///< how likely a partner meets its box, up to a common factor
    std::uint32_t level = 0;  ///< 0 for the root
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct BinaryTree {
    std::vector<BinaryNode> nodes;     ///< the root first
    std::vector<std::uint32_t> order;  ///< triangle indices
};

/// Splits the leaves of `binary` down to groups of at most settings.maxLeafTriangles, new nodes behind the old ones and
/// triangles only moved within their leaf; then fills in the reach of all nodes. Reads only `tree.vertices` and
/// `tree.triangles`. At most 64 + 28 levels deep, whatever the mesh, if no leaf is deeper than 64 to start with.
Sliced splitLeavesInSlices(const Tree& tree, const BuildSettings& settings, BinaryTree& binary);
void splitLeaves(const Tree& tree, const BuildSettings& settings, BinaryTree& binary);

/// All triangles, split from the root down.
Sliced sortInTwosInSlices(const Tree& tree, const BuildSettings& settings, BinaryTree& all);

}  // namespace grapeshot::detail
