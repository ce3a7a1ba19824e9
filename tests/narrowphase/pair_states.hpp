// What tests of pairs that go on from step to step share.
#pragma once

#include <chrono>
#include <cstring>

#include <grapeshot/narrowphase/pair_update.hpp>

namespace grapeshot::test {

/// Byte by byte.
inline bool sameContacts(const PairState& left, const PairState& right) {
    const ContactSet& l = left.contacts;
    const ContactSet& r = right.contacts;
    return l.nextId == r.nextId && l.droppedRegions == r.droppedRegions && l.slots.size() == r.slots.size() &&
           (l.slots.empty() || std::memcmp(l.slots.data(), r.slots.data(), l.slots.size() * sizeof(RegionSlot)) == 0);
}

/// A clock that goes on by a microsecond whenever it is read.
inline std::chrono::nanoseconds tick() noexcept {
    static std::chrono::nanoseconds time{0};
    return time += std::chrono::microseconds(1);
}

}  // namespace grapeshot::test
