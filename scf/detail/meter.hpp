// Is there anything left of the budget? For loops that spend a few units at a time.
#pragma once

#include <chrono>
#include <cstdint>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/purse.hpp>

namespace grapeshot::detail {

class Meter {
  public:
    explicit Meter(const Budget& budget) : m_work(budget.work), m_purse(timeOnly(budget)) {
        m_late = m_purse.isTimed() && m_purse.isEmpty();
    }
    [[nodiscard]] bool isUnlimited() const { return m_work == unlimited && !m_purse.isTimed(); }
    /// Units after `spent`; 0 if the time is up, which is looked at every 32 units.
    [[nodiscard]] std::uint64_t left(std::uint64_t spent) {
        if (m_purse.isTimed() && !m_late && spent >= m_nextLook) {
            m_nextLook = spent + 32;
            m_late = m_purse.isEmpty();
        }
        if (m_late) {
            return 0;
        }
        return m_work == unlimited ? unlimited : m_work - (spent < m_work ? spent : m_work);
    }

  private:
    static Budget timeOnly(Budget budget) {
        budget.work = unlimited;
        return budget;
    }
    std::uint64_t m_work;
    Purse m_purse;
    std::uint64_t m_nextLook = 32;
    bool m_late = false;
};

/// Of so many units; of unlimited ones all.
[[nodiscard]] inline std::uint64_t shareOf(std::uint64_t units, double share) {
    return units == unlimited ? unlimited : static_cast<std::uint64_t>(static_cast<double>(units) * share);
}

}  // namespace grapeshot::detail
