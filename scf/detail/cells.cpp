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
    }

  private:
    void visit(BallRef ref, std::uint32_t cell) {
        const std::uint32_t index = ballIndex(ref);
        if (cell == noCell && (isBallLeaf(ref) || m_isCell[index] != 0)) {
            cell = static_cast<std::uint32_t>(m_out.cells.size());
            m_out.cells.push_back(ref);
            if (!isBallLeaf(ref)) {
                m_out.cellOfNode[index] = cell;
            }
        }
        if (isBallLeaf(ref)) {
            m_out.cellOfLeaf[index] = cell;
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

void listNeighbours(const BallTree& tree, Cells& cells) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    std::vector<std::uint32_t> around;
    for (std::uint32_t v = 0; v < tree.surface.rest.size(); ++v) {
        around.clear();
        for (const std::uint32_t t : tree.surface.fan.of(v)) {
            around.push_back(cells.cellOf(tree, t));
        }
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (std::size_t i = 0; i < around.size(); ++i) {
            for (std::size_t j = 0; j < around.size(); ++j) {
                if (i != j) {
                    pairs.emplace_back(around[i], around[j]);
                }
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    cells.neighbours.begin.assign(cells.cells.size() + 1, 0);
    for (const auto& [from, to] : pairs) {
        ++cells.neighbours.begin[from + 1];
        cells.neighbours.all.push_back(to);
    }
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        cells.neighbours.begin[i + 1] += cells.neighbours.begin[i];
    }
}

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
    listNeighbours(tree, cells);
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

}  // namespace grapeshot::detail
