// How much a query may cost, and why it stopped.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

namespace grapeshot {

inline constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
inline constexpr std::chrono::nanoseconds never = std::chrono::nanoseconds::max();

/// An upper limit on the work of one query. Work is counted in calls of a 16-wide kernel (16 node pairs, triangle
/// pairs, ...), so that the same budget gives the same bytes on every machine. Time is a second, opt-in stop, looked at
/// every 32 units or oftener, and gives up reproducibility. A budget of zero (or less) returns at once with what is
/// known without work; it is not an error.
struct Budget {
    std::uint64_t work = unlimited;
    std::chrono::nanoseconds time = never;
    /// Time source for `time`; null is std::chrono::steady_clock. Tests inject their own.
    std::chrono::nanoseconds (*clock)() noexcept = nullptr;
};

/// What the budget's clock says.
[[nodiscard]] inline std::chrono::nanoseconds timeOf(const Budget& budget) noexcept {
    return budget.clock != nullptr ? budget.clock()
                                   : std::chrono::duration_cast<std::chrono::nanoseconds>(
                                         std::chrono::steady_clock::now().time_since_epoch());
}

enum class StopReason {
    certain,       ///< proven; more work would change nothing
    probability,   ///< sure enough by the settings
    budget,        ///< work or time used up; can be resumed
    invalidInput,  ///< nothing was computed: NaN or non-rigid pose, a setting out of range
};

}  // namespace grapeshot
