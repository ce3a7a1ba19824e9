// What is left of a budget that several parts of one step share.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include <grapeshot/core/budget.hpp>

namespace grapeshot {

/// A limit of time counts from when it is made. Not for two threads.
class Purse {
  public:
    explicit Purse(const Budget& budget) : m_budget(budget) {
        if (isTimed()) {
            m_start = timeOf(m_budget);
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
            rest.time = std::max(std::chrono::nanoseconds(0), rest.time - (timeOf(m_budget) - m_start));
        }
        return rest;
    }
    [[nodiscard]] bool isEmpty() const {
        const Budget rest = left();
        return rest.work == 0 || rest.time <= std::chrono::nanoseconds(0);
    }

  private:
    Budget m_budget;
    std::chrono::nanoseconds m_start{0};
    std::uint64_t m_spent = 0;
};

}  // namespace grapeshot
