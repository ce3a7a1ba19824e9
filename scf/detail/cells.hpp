// A surface cut into pieces of about one size: what contacts are told apart by, and where sampling begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot::detail {

inline constexpr std::uint32_t noCell = 0xffffffffU;

struct Cells {
    std::vector<BallRef> cells;             ///< in the order of the tree: pieces of a piece stand together
    std::vector<std::uint32_t> cellOfNode;  ///< noCell above and below the cut
    std::vector<std::uint32_t> cellOfLeaf;  ///< that it lies in
    IndexLists neighbours;                  ///< cells that share a vertex with a cell, ascending; if asked for
    /// Per leaf: is it so much larger than the cells should be that one contact does not stand for it?
    std::vector<char> coarse;

    [[nodiscard]] bool isCell(BallRef ref) const { return isBallLeaf(ref) || cellOfNode[ballIndex(ref)] != noCell; }
    [[nodiscard]] std::uint32_t cellAt(BallRef ref) const {
        return isBallLeaf(ref) ? cellOfLeaf[ballIndex(ref)] : cellOfNode[ballIndex(ref)];
    }
    [[nodiscard]] std::uint32_t cellOf(const BallTree& tree, std::uint32_t triangle) const {
        return cellOfLeaf[tree.leafOfTriangle[triangle]];
    }
    /// What tells contacts apart: the cell, or the triangle itself where the mesh is coarser than the cells should be.
    [[nodiscard]] std::uint32_t idOf(const BallTree& tree, std::uint32_t triangle) const {
        const std::uint32_t leaf = tree.leafOfTriangle[triangle];
        return coarse[leaf] != 0 ? static_cast<std::uint32_t>(cells.size()) + triangle : cellOfLeaf[leaf];
    }
};

/// The largest pieces with at most this radius at rest, and leaves that are larger. With neighbours. O(n).
[[nodiscard]] Cells cellsOfRadius(const BallTree& tree, float radius);

/// About so many pieces (at most 3 more), the largest being cut first. Without neighbours.
[[nodiscard]] Cells cellsOfCount(const BallTree& tree, std::size_t count);

}  // namespace grapeshot::detail
