// Which build of the wide kernels runs.
#pragma once

#include <string_view>

namespace grapeshot {

/// All three give the same bytes.
enum class InstructionSet { scalar, avx2, avx512 };

/// The best that this machine has, unless narrowed by `limitInstructionSet` or by the environment variable
/// GRAPESHOT_ISA (scalar | avx2 | avx512), which is read once.
[[nodiscard]] InstructionSet instructionSet() noexcept;

/// Use no better set than this from now on, in the whole process. For tests and benchmarks; not while queries run.
/// Returns what will really be used (the machine may have less).
InstructionSet limitInstructionSet(InstructionSet best) noexcept;

[[nodiscard]] std::string_view name(InstructionSet set) noexcept;

}  // namespace grapeshot
