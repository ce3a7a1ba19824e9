// A surface cut into pieces of about one size: what contacts are told apart by, and where sampling begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot::detail {

inline constexpr std::uint32_t noCell = 0xffffffffU;

struct Cells {
    std::vector<BallRef> cells;             ///< in the order of the tree: pieces of a piece stand together
    std::vector<PieceBall> own;             ///< their balls
    std::vector<std::uint32_t> cellOfNode;  ///< noCell above and below the cut
    std::vector<std::uint32_t> cellOfLeaf;  ///< that it lies in
    IndexLists leaves;                      ///< of each cell
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

/// The largest pieces with at most this radius at rest, and leaves that are larger. A look at every leaf and node, some
/// 10 ns each.
[[nodiscard]] Cells cellsOfRadius(const BallTree& tree, float radius);

/// About so many pieces (at most 3 more), the largest being cut first.
[[nodiscard]] Cells cellsOfCount(const BallTree& tree, std::size_t count);

/// Cells that share a vertex with a cell, ascending, in place of `out`. O(size of the cell).
void listNeighbours(const BallTree& tree, const Cells& cells, std::uint32_t cell, std::vector<std::uint32_t>& out);

/// The same of all cells. O(n).
[[nodiscard]] IndexLists neighboursOfAll(const BallTree& tree, const Cells& cells);

/// The same of those that are asked for, each listed once: a step looks at few, and has no time for all of a large
/// mesh.
class CellNeighbours {
  public:
    /// Of other cells from now on, so many.
    void begin(std::size_t cells);
    /// Valid until the next call.
    [[nodiscard]] std::span<const std::uint32_t> of(const BallTree& tree, const Cells& cells, std::uint32_t cell);

  private:
    struct List {
        std::uint32_t begin = noCell;  ///< not listed yet
        std::uint32_t count = 0;
    };
    std::vector<List> m_lists;
    std::vector<std::uint32_t> m_all, m_some;
};

}  // namespace grapeshot::detail
