// Which feature pairs were seen already; keeps its memory from call to call.
#pragma once

#include <cstdint>
#include <vector>

namespace grapeshot::detail {

/// A feature of each side: corner (id, id), edge (lower id, higher id), face (all ones, triangle). Ids are welded.
struct FeaturePairKey {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    friend auto operator<=>(const FeaturePairKey&, const FeaturePairKey&) = default;
};

[[nodiscard]] constexpr std::uint64_t cornerKey(std::uint32_t vertex) noexcept {
    return (std::uint64_t{vertex} << 32U) | vertex;
}
[[nodiscard]] constexpr std::uint64_t edgeKey(std::uint32_t v, std::uint32_t w) noexcept {
    return v < w ? (std::uint64_t{v} << 32U) | w : (std::uint64_t{w} << 32U) | v;
}
[[nodiscard]] constexpr std::uint64_t faceKey(std::uint32_t triangle) noexcept {
    return (std::uint64_t{0xffffffffU} << 32U) | triangle;
}
[[nodiscard]] constexpr bool isCorner(std::uint64_t key) noexcept {
    return (key >> 32U) == (key & 0xffffffffU);
}

/// Open addressing, linear probing. The layout never shows: only membership and values are asked.
class KeyTable {
  public:
    void clear() {
        ++m_epoch;
        m_size = 0;
        if (m_slots.empty() || m_epoch == 0) {
            m_slots.assign(m_slots.empty() ? 256 : m_slots.size(), Slot{});
            m_epoch = 1;
        }
    }

    /// The value stored under the key; inserted as `fresh` if the key is new. Valid until the next call.
    std::uint32_t& at(const FeaturePairKey& key, std::uint32_t fresh) {
        if (2 * (m_size + 1) > m_slots.size()) {
            grow();
        }
        Slot& slot = find(key);
        if (slot.epoch != m_epoch) {
            slot = {key, fresh, m_epoch};
            ++m_size;
        }
        return slot.value;
    }

  private:
    struct Slot {
        FeaturePairKey key;
        std::uint32_t value = 0;
        std::uint32_t epoch = 0;
    };

    Slot& find(const FeaturePairKey& key) {
        std::uint64_t hash = key.a * 0x9e3779b97f4a7c15U ^ (key.b + 0x7f4a7c15U) * 0xc2b2ae3d27d4eb4fU;
        hash ^= hash >> 29U;
        hash *= 0xbf58476d1ce4e5b9U;
        hash ^= hash >> 32U;
        const std::size_t mask = m_slots.size() - 1;
        std::size_t place = hash & mask;
        while (m_slots[place].epoch == m_epoch && m_slots[place].key != key) {
            place = (place + 1) & mask;
        }
        return m_slots[place];
    }

    void grow() {
        std::vector<Slot> old(2 * m_slots.size());
        old.swap(m_slots);
        for (const Slot& slot : old) {
            if (slot.epoch == m_epoch) {
                find(slot.key) = slot;
            }
        }
    }

    std::vector<Slot> m_slots;
    std::size_t m_size = 0;
    std::uint32_t m_epoch = 0;
};

}  // namespace grapeshot::detail
