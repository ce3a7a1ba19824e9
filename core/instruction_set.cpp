#include <grapeshot/core/instruction_set.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>

#include <grapeshot/core/detail/wide_targets.hpp>

#include <hwy/targets.h>

#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot {

namespace detail {

std::atomic<int> chosenInstructionSet{-1};

namespace {

constexpr std::array<std::string_view, 3> names = {"scalar", "avx2", "avx512"};

/// What the machine has of the sets that were compiled, narrowed by the environment.
int bestInstructionSet() noexcept {
    int best = 0;
#if HWY_TARGETS & HWY_AVX2
    const auto supported = hwy::SupportedTargets();
    if ((supported & HWY_AVX2) != 0) {
        best = (supported & HWY_AVX3) != 0 ? 2 : 1;
    }
#endif
    if (const char* wish = std::getenv("GRAPESHOT_ISA")) {
        const auto found = std::find(names.begin(), names.end(), std::string_view(wish));
        if (found != names.end()) {
            best = std::min(best, static_cast<int>(found - names.begin()));
        }
    }
    return best;
}

int bestOnce() noexcept {
    static const int best = bestInstructionSet();
    return best;
}

}  // namespace

int resolveInstructionSet() noexcept {
    int unresolved = -1;
    chosenInstructionSet.compare_exchange_strong(unresolved, bestOnce(), std::memory_order_relaxed);
    return chosenInstructionSet.load(std::memory_order_relaxed);
}

}  // namespace detail

InstructionSet instructionSet() noexcept {
    const int chosen = detail::chosenInstructionSet.load(std::memory_order_relaxed);
    return static_cast<InstructionSet>(chosen >= 0 ? chosen : detail::resolveInstructionSet());
}

InstructionSet limitInstructionSet(InstructionSet best) noexcept {
    const int limited = std::min(static_cast<int>(best), detail::bestOnce());
    detail::chosenInstructionSet.store(limited, std::memory_order_relaxed);
    return static_cast<InstructionSet>(limited);
}

std::string_view name(InstructionSet set) noexcept {
    return detail::names[static_cast<std::size_t>(set)];
}

}  // namespace grapeshot
