// The pairs of cells that may be in contact: the traversal of both trees down to a cut.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/detail/prefetch.hpp>

namespace grapeshot::detail {

/// Everything within reach of each other lies in one of the pairs that are visited, if it runs to the end.
class Front {
  public:
    /// visit(pair, weight) -> bool: go on? `weight` as overlappingBalls has it. Of a body with itself each pair of
    /// cells comes once, the first cell first.
    /// @param mayGoOn () -> bool, asked before every step
    /// @return was everything visited?
    template <class Visit, class MayGoOn>
    bool run(const PairSpace& space, const Cells& cellsA, const Cells& cellsB, std::uint64_t& work, Visit&& visit,
             MayGoOn&& mayGoOn) {
        m_stack.assign(1, {{0, 0}, 1});
        ChildPairs children;
        float weight[16];
        while (!m_stack.empty()) {
            const Item item = m_stack.back();
            m_stack.pop_back();
            // The root is opened even if it is small enough to be a cell.
            const bool cellA = item.pair.a != 0 && cellsA.isCell(item.pair.a);
            const bool cellB = item.pair.b != 0 && cellsB.isCell(item.pair.b);
            if (cellA && cellB) {
                if (!visit(item.pair, item.weight)) {
                    return false;
                }
                continue;
            }
            if (!mayGoOn()) {
                return false;
            }
            if (!m_stack.empty()) {
                prefetchPoints(space, m_stack.back().pair);
            }
            work += space.expand(item.pair, children, &weight, cellA, cellB);
            prefetchChildren(space, children);
            for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
                const auto lane = static_cast<unsigned>(std::countr_zero(left));
                m_stack.push_back({children.at(lane), weight[lane]});
            }
        }
        return true;
    }

  private:
    struct Item {
        BallPair pair;
        float weight;
    };
    std::vector<Item> m_stack;
};

}  // namespace grapeshot::detail
