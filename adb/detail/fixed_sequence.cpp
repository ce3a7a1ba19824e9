#include <grapeshot/adb/detail/fixed_sequence.hpp>

#include <grapeshot/core/rate_bound.hpp>

namespace grapeshot::detail {

std::int64_t mostErrorsAllowed(std::uint64_t trials, double limit, double confidence) {
    if (trials == 0 || upperRate(0, trials, confidence) > limit) {
        return -1;
    }
    // The bound rises with the count, and is 1 when all err.
    std::uint64_t passes = 0;
    std::uint64_t fails = trials;
    while (fails - passes > 1) {
        const std::uint64_t middle = passes + (fails - passes) / 2;
        (upperRate(middle, trials, confidence) <= limit ? passes : fails) = middle;
    }
    return static_cast<std::int64_t>(passes);
}

PathEnd walkPath(std::span<const std::uint64_t> errors, std::int64_t mostErrors) noexcept {
    PathEnd end;
    for (const std::uint64_t count : errors) {
        if (mostErrors < 0 || count > static_cast<std::uint64_t>(mostErrors)) {
            break;
        }
        ++end.passed;
        end.errors = count;
    }
    return end;
}

}  // namespace grapeshot::detail
