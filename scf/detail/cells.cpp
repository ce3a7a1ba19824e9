#include <grapeshot/scf/detail/cells.hpp>

#include <algorithm>
#include <queue>
#include <utility>

namespace grapeshot::detail {
namespace {

/// Numbers the marked nodes, and the leaves that are in none.
class Numbering {
  public:
    Numbering(const BallTree& tree, const std::vector<char>& isCell, Cells& out)
        : m_tree(tree), m_isCell(isCell), m_out(out) {
        m_out.cellOfNode.assign(tree.nodes.size(), noCell);
        m_out.cellOfLeaf.assign(tree.leaves.size(), noCell);
        visit(0, noCell);
        m_out.leaves.begin.push_back(static_cast<std::uint32_t>(m_out.leaves.all.size()));
    }

  private:
    void visit(BallRef ref, std::uint32_t cell) {
        const std::uint32_t index = ballIndex(ref);
        if (cell == noCell && (isBallLeaf(ref) || m_isCell[index] != 0)) {
            cell = static_cast<std::uint32_t>(m_out.cells.size());
            m_out.cells.push_back(ref);
            m_out.own.push_back(m_tree.own(ref));
            m_out.leaves.begin.push_back(static_cast<std::uint32_t>(m_out.leaves.all.size()));
            if (!isBallLeaf(ref)) {
                m_out.cellOfNode[index] = cell;
            }
        }
        if (isBallLeaf(ref)) {
            m_out.cellOfLeaf[index] = cell;
            m_out.leaves.all.push_back(index);
            return;
        }
        for (std::uint32_t slot = 0; slot < m_tree.nodes[index].count; ++slot) {
            visit(m_tree.nodes[index].child[slot], cell);
        }
    }

    const BallTree& m_tree;
    const std::vector<char>& m_isCell;
    Cells& m_out;
};

}  // namespace

Cells cellsOfRadius(const BallTree& tree, float radius) {
    std::vector<char> isCell(tree.nodes.size(), 0);
    for (std::size_t i = 0; i < isCell.size(); ++i) {
        isCell[i] = tree.nodes[i].own.radius <= radius ? 1 : 0;
    }
    Cells cells;
    Numbering(tree, isCell, cells);
    cells.coarse.resize(tree.leaves.size());
    for (std::size_t i = 0; i < cells.coarse.size(); ++i) {
        cells.coarse[i] = tree.leaves[i].own.radius > 2 * radius ? 1 : 0;
    }
    return cells;
}

Cells cellsOfCount(const BallTree& tree, std::size_t count) {
    std::vector<char> isCell(tree.nodes.size(), 0);
    const auto smaller = [&](BallRef a, BallRef b) {
        return tree.own(a).radius != tree.own(b).radius ? tree.own(a).radius < tree.own(b).radius : a > b;
    };
    std::priority_queue<BallRef, std::vector<BallRef>, decltype(smaller)> queue(smaller);
    std::size_t cells = 0;  // beside those in the queue
    const auto open = [&](std::uint32_t node) {
        for (std::uint32_t slot = 0; slot < tree.nodes[node].count; ++slot) {
            const BallRef child = tree.nodes[node].child[slot];
            if (isBallLeaf(child)) {
                ++cells;
            } else {
                queue.push(child);
            }
        }
    };
    open(0);
    while (!queue.empty() && cells + queue.size() < count) {
        const BallRef largest = queue.top();
        queue.pop();
        open(largest);
    }
    for (; !queue.empty(); queue.pop()) {
        isCell[queue.top()] = 1;
    }
    Cells result;
    Numbering(tree, isCell, result);
    return result;
}

void listNeighbours(const BallTree& tree, const Cells& cells, std::uint32_t cell, std::vector<std::uint32_t>& out) {
    out.clear();
    for (const std::uint32_t leaf : cells.leaves.of(cell)) {
        for (const std::uint32_t v : tree.leafVertices.of(leaf)) {
            for (const std::uint32_t t : tree.surface.fan.of(v)) {
                const std::uint32_t other = cells.cellOf(tree, t);
                if (other != cell && (out.empty() || out.back() != other)) {
                    out.push_back(other);
                }
            }
        }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
}

IndexLists neighboursOfAll(const BallTree& tree, const Cells& cells) {
    IndexLists lists;
    lists.begin.push_back(0);
    std::vector<std::uint32_t> some;
    for (std::uint32_t cell = 0; cell < cells.cells.size(); ++cell) {
        listNeighbours(tree, cells, cell, some);
        lists.all.insert(lists.all.end(), some.begin(), some.end());
        lists.begin.push_back(static_cast<std::uint32_t>(lists.all.size()));
    }
    return lists;
}

void CellNeighbours::begin(std::size_t cells) {
    m_lists.assign(cells, {});
    m_all.clear();
}

std::span<const std::uint32_t> CellNeighbours::of(const BallTree& tree, const Cells& cells, std::uint32_t cell) {
    List& list = m_lists[cell];
    if (list.begin == noCell) {
        listNeighbours(tree, cells, cell, m_some);
        list = {static_cast<std::uint32_t>(m_all.size()), static_cast<std::uint32_t>(m_some.size())};
        m_all.insert(m_all.end(), m_some.begin(), m_some.end());
    }
    return std::span(m_all).subspan(list.begin, list.count);
}

}  // namespace grapeshot::detail
