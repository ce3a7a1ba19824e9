// What a tree's leaves and nodes say of the triangles below them.
#pragma once

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// Half extents of an empty slot: so negative that no box with it comes within any distance up to `maxInflation`, and
/// so small that three of them add up without overflow.
inline constexpr float emptyHalf = -1e36F;
inline constexpr float maxInflation = 1e35F;

/// Fills in everything but the shape: corners of the leaves, boxes, slabs, moments, extent, from `vertices`,
/// `triangles`, the children and the leaves' triangle indices. O(n) for all but the slabs, which look at every triangle
/// once a level.
Sliced fillContentsInSlices(Tree& tree);
void fillContents(Tree& tree);

/// Consecutive leaf blocks [begin, end) below each node.
struct LeafRange {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
};
[[nodiscard]] std::vector<LeafRange> leafRanges(const Tree& tree);

}  // namespace grapeshot::detail
