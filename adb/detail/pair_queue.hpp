// Node pairs, the one with the largest margin first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/detail/descent.hpp>

namespace grapeshot::detail {

/// A heap that grows as needed and never drops a pair; keeps its memory when cleared. Equal margins come out in the
/// order they went in, so the order of all is fixed.
class PairQueue {
  public:
    void clear() {
        m_heap.clear();
        m_pushed = 0;
    }
    [[nodiscard]] bool empty() const { return m_heap.empty(); }
    void push(SidePair pair, float margin);
    [[nodiscard]] SidePair top() const { return m_heap.front().pair; }
    void pop();

    struct Entry {
        float margin;          ///< m
        std::uint64_t number;  ///< of those that were pushed before it
        SidePair pair;
    };
    /// In no particular order; those that were pushed so far. `restore` takes any order, and numbers below `pushed`.
    [[nodiscard]] std::span<const Entry> entries() const { return m_heap; }
    [[nodiscard]] std::uint64_t pushed() const { return m_pushed; }
    void restore(std::vector<Entry> entries, std::uint64_t pushed);

  private:
    /// A type, so that heaps inline it.
    struct ComesLater {
        bool operator()(const Entry& a, const Entry& b) const {
            return a.margin != b.margin ? a.margin < b.margin : a.number > b.number;
        }
    };

    std::vector<Entry> m_heap;
    std::uint64_t m_pushed = 0;
};

}  // namespace grapeshot::detail
