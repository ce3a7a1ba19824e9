// How a query spends its budget.
#pragma once

#include <algorithm>

#include <grapeshot/core/budget.hpp>

namespace grapeshot::detail {

/// Units between two looks at the clock.
inline constexpr std::uint64_t unitsPerLook = 32;

/// Calls run(units), which spends at most so many and says true when there is nothing left to do, until it does or the
/// budget is used up. Returns what the last call said. `spent()` is the total of units spent so far.
template <typename Run, typename Spent>
bool spend(const Budget& budget, const Spent& spent, const Run& run) {
    if (budget.time == never) {
        return run(budget.work);
    }
    if (budget.time <= std::chrono::nanoseconds::zero()) {
        return run(std::uint64_t{0});
    }
    const std::chrono::nanoseconds start = timeOf(budget);
    const std::uint64_t first = spent();
    for (;;) {
        const std::uint64_t left = budget.work - (spent() - first);
        if (run(std::min(left, unitsPerLook))) {
            return true;
        }
        if (left <= unitsPerLook || timeOf(budget) - start >= budget.time) {
            return false;
        }
    }
}

}  // namespace grapeshot::detail
