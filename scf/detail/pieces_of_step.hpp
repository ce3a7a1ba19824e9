// What a step makes of a tree's nodes and leaves the first time that it asks for them; nothing is emptied between
// steps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

namespace grapeshot::detail {

/// Not for two threads. References hold until the next `begin`.
/// @tparam Balls of the children of a node
template <class Balls, class Leaf>
class PiecesOfStep {
  public:
    PiecesOfStep(std::size_t nodes, std::size_t leaves)
        : m_nodeStamp(nodes, 0), m_leafStamp(leaves, 0), m_leafSlot(leaves, 0), m_balls(nodes) {}

    /// For another tree; what was made is forgotten at the next `begin`. Memory only grows.
    void makeRoom(std::size_t nodes, std::size_t leaves) {
        if (nodes > m_balls.size()) {
            m_nodeStamp.resize(nodes, 0);
            m_balls.resize(nodes);
        }
        if (leaves > m_leafStamp.size()) {
            m_leafStamp.resize(leaves, 0);
            m_leafSlot.resize(leaves, 0);
        }
    }

    void begin() {
        if (++m_step == 0) {  // after 2^32 of them
            std::fill(m_nodeStamp.begin(), m_nodeStamp.end(), 0);
            std::fill(m_leafStamp.begin(), m_leafStamp.end(), 0);
            m_step = 1;
        }
        m_usedLeaves = 0;
    }

    [[nodiscard]] bool hasBalls(std::uint32_t node) const { return m_nodeStamp[node] == m_step; }
    [[nodiscard]] bool hasLeaf(std::uint32_t leaf) const { return m_leafStamp[leaf] == m_step; }
    void prefetchBalls(std::uint32_t node) const {
        __builtin_prefetch(&m_nodeStamp[node]);
        __builtin_prefetch(&m_balls[node]);
    }

    /// @param make fills in Balls&, if this step has not done it yet; may ask for other nodes
    template <class Make>
    const Balls& balls(std::uint32_t node, const Make& make) {
        if (m_nodeStamp[node] != m_step) {
            m_nodeStamp[node] = m_step;
            make(m_balls[node]);
        }
        return m_balls[node];
    }
    template <class Make>
    const Leaf& leaf(std::uint32_t index, const Make& make) {
        if (m_leafStamp[index] != m_step) {
            m_leafStamp[index] = m_step;
            m_leafSlot[index] = static_cast<std::uint32_t>(m_usedLeaves);
            if (m_usedLeaves == m_leaves.size()) {
                m_leaves.emplace_back();
            }
            make(m_leaves[m_usedLeaves++]);
        }
        return m_leaves[m_leafSlot[index]];
    }

  private:
    std::uint32_t m_step = 0;
    std::vector<std::uint32_t> m_nodeStamp, m_leafStamp, m_leafSlot;
    std::vector<Balls> m_balls;
    std::deque<Leaf> m_leaves;  ///< of this step, in the order in which they were asked for
    std::size_t m_usedLeaves = 0;
};

}  // namespace grapeshot::detail
