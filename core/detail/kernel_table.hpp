// One kernel, compiled for each instruction set, and the one that runs. See wide.hpp for how to write a kernel.
#pragma once

#include <atomic>

#include <grapeshot/core/instruction_set.hpp>

namespace grapeshot::detail {

/// Index into KernelTable, an InstructionSet; negative until the machine has been asked. Written by
/// `limitInstructionSet` only.
extern std::atomic<int> chosenInstructionSet;

/// Asks machine and environment, once. Returns the index.
int resolveInstructionSet() noexcept;

/// The same function for InstructionSet::scalar, avx2, avx512. Costs one load and one indirect call.
template <class Function>
struct KernelTable {
    Function* of[3];

    [[nodiscard]] Function* chosen() const noexcept {
        int index = chosenInstructionSet.load(std::memory_order_relaxed);
        if (index < 0) [[unlikely]] {
            index = resolveInstructionSet();
        }
        return of[index];
    }
};

}  // namespace grapeshot::detail

/// The table of `function`, which every target defined in its HWY_NAMESPACE. Use in namespace grapeshot::detail, under
/// #if HWY_ONCE. A set that was not compiled (GRAPESHOT_SCALAR, other processors) falls back to the twin; it is never
/// chosen.
#if HWY_TARGETS & HWY_AVX2
#define GRAPESHOT_KERNEL_TABLE(function)                             \
    ::grapeshot::detail::KernelTable<decltype(N_SCALAR::function)> { \
        &N_SCALAR::function, &N_AVX2::function, &N_AVX3::function    \
    }
#else
#define GRAPESHOT_KERNEL_TABLE(function)                              \
    ::grapeshot::detail::KernelTable<decltype(N_SCALAR::function)> {  \
        &N_SCALAR::function, &N_SCALAR::function, &N_SCALAR::function \
    }
#endif
