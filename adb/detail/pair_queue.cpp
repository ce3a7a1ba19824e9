#include <grapeshot/adb/detail/pair_queue.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace grapeshot::detail {

void PairQueue::push(SidePair pair, float margin) {
    if (!(margin == margin)) {
        margin = std::numeric_limits<float>::max();  // NaN has no place in an order
    }
    m_heap.push_back({margin, m_pushed++, pair});
    std::push_heap(m_heap.begin(), m_heap.end(), ComesLater());
}

void PairQueue::pop() {
    std::pop_heap(m_heap.begin(), m_heap.end(), ComesLater());
    m_heap.pop_back();
}

void PairQueue::restore(std::vector<Entry> entries, std::uint64_t pushed) {
    m_heap = std::move(entries);
    m_pushed = pushed;
    std::make_heap(m_heap.begin(), m_heap.end(), ComesLater());
}

}  // namespace grapeshot::detail
