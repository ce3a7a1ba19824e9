// Triangle tests of many leaf pairs, for as long as a budget lasts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <grapeshot/core/purse.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>

namespace grapeshot::detail {

/// Leaf pairs that are tested between two looks at the clock.
inline constexpr std::size_t pairsPerLook = 32;

/// Feeds the search from the front as long as there is something left. Returns how many were tested.
inline std::size_t testSome(std::span<const LeafPair> pairs, Purse& purse, LocalContactSearch& search) {
    std::size_t tested = 0;
    while (tested < pairs.size()) {
        const std::uint64_t before = search.work();
        const auto rest = pairs.subspan(tested);
        const auto some = purse.isTimed() ? rest.first(std::min(rest.size(), pairsPerLook)) : rest;
        const std::size_t done = search.add(some, purse.left().work);
        purse.pay(search.work() - before);
        tested += done;
        if (done < some.size() || (tested < pairs.size() && purse.isEmpty())) {
            break;
        }
    }
    return tested;
}

/// The same; true if all were tested.
inline bool testPairs(std::span<const LeafPair> pairs, Purse& purse, LocalContactSearch& search) {
    return testSome(pairs, purse, search) == pairs.size();
}

}  // namespace grapeshot::detail
