// What is left of a budget that several parts of one step share.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <span>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>

namespace grapeshot::detail {

class Purse {
  public:
    explicit Purse(const Budget& budget) : m_budget(budget) {
        if (isTimed()) {
            m_start = now();
        }
    }
    void pay(std::uint64_t work) { m_spent += work; }
    [[nodiscard]] std::uint64_t spent() const { return m_spent; }
    [[nodiscard]] bool isTimed() const { return m_budget.time != never; }
    [[nodiscard]] bool isUnlimited() const { return m_budget.work == unlimited && !isTimed(); }
    [[nodiscard]] Budget left() const {
        Budget rest = m_budget;
        if (rest.work != unlimited) {
            rest.work -= std::min(rest.work, m_spent);
        }
        if (rest.time != never) {
            rest.time = std::max(std::chrono::nanoseconds(0), rest.time - (now() - m_start));
        }
        return rest;
    }
    [[nodiscard]] bool isEmpty() const {
        const Budget rest = left();
        return rest.work == 0 || rest.time <= std::chrono::nanoseconds(0);
    }

  private:
    [[nodiscard]] std::chrono::nanoseconds now() const {
        return m_budget.clock != nullptr ? m_budget.clock()
                                         : std::chrono::duration_cast<std::chrono::nanoseconds>(
                                               std::chrono::steady_clock::now().time_since_epoch());
    }
    Budget m_budget;
    std::chrono::nanoseconds m_start{0};
    std::uint64_t m_spent = 0;
};

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
