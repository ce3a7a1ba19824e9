// A hash table from 64-bit keys to numbers that is emptied in no time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace grapeshot::detail {

class KeyMap {
  public:
    void clear() {
        m_size = 0;
        if (++m_round == 0) {
            m_slots.assign(m_slots.size(), {});
            m_round = 1;
        }
    }
    [[nodiscard]] std::size_t size() const { return m_size; }

    /// Null if the key is not there.
    [[nodiscard]] std::uint32_t* find(std::uint64_t key) {
        if (m_slots.empty()) {
            return nullptr;
        }
        Slot& slot = m_slots[place(key)];
        return slot.round == m_round ? &slot.value : nullptr;
    }

    struct Entry {
        std::uint32_t& value;  ///< until the next insertion
        bool isNew;
    };
    Entry insert(std::uint64_t key, std::uint32_t value) {
        if (2 * (m_size + 1) > m_slots.size()) {
            grow();
        }
        Slot& slot = m_slots[place(key)];
        if (slot.round == m_round) {
            return {slot.value, false};
        }
        slot = {key, value, m_round};
        ++m_size;
        return {slot.value, true};
    }

  private:
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t value = 0;
        std::uint32_t round = 0;  ///< in which it was filled
    };
    /// Where the key is, or would be.
    [[nodiscard]] std::size_t place(std::uint64_t key) const {
        const std::size_t mask = m_slots.size() - 1;
        // Fibonacci hashing, with the upper half folded in.
        std::size_t i = ((key ^ key >> 32U) * 0x9e3779b97f4a7c15U >> 20U) & mask;
        while (m_slots[i].round == m_round && m_slots[i].key != key) {
            i = (i + 1) & mask;
        }
        return i;
    }
    void grow() {
        std::vector<Slot> old(m_slots.empty() ? 256 : 2 * m_slots.size());
        old.swap(m_slots);
        for (const Slot& slot : old) {
            if (slot.round == m_round) {
                m_slots[place(slot.key)] = slot;
            }
        }
    }

    std::vector<Slot> m_slots;
    std::size_t m_size = 0;
    std::uint32_t m_round = 1;
};

}  // namespace grapeshot::detail
