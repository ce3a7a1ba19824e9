// The nodes still to be visited by a descent into one tree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace grapeshot::detail {

/// Last in, first out. Built trees fit into the inline part (see maxBinnedLevel in binary_tree.cpp); deeper ones that
/// somebody made by hand go on in a vector.
template <typename Entry>
class NodeStack {
  public:
    void push(const Entry& entry) {
        if (m_size < m_inline.size()) {
            m_inline[m_size++] = entry;
        } else {
            m_spilt.push_back(entry);
        }
    }
    Entry pop() {
        if (!m_spilt.empty()) {
            const Entry entry = m_spilt.back();
            m_spilt.pop_back();
            return entry;
        }
        return m_inline[--m_size];
    }
    [[nodiscard]] bool empty() const { return m_size == 0; }

  private:
    std::array<Entry, 320> m_inline;
    std::size_t m_size = 0;
    std::vector<Entry> m_spilt;
};

}  // namespace grapeshot::detail
