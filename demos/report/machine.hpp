// Where and by what a number was measured.
#pragma once

#include <string>

namespace grapeshot::report {

struct Machine {
    std::string commit;  ///< of the sources at build time; "+" behind it: with local changes
    std::string cpu, isa, compiler;
};
[[nodiscard]] Machine machine();

/// CPU time of this thread, us: other processes do not count, but their use of the caches does.
[[nodiscard]] double threadCpuUs() noexcept;
/// Monotonic time, us: cheap enough to be read around a single query.
[[nodiscard]] double wallUs() noexcept;

}  // namespace grapeshot::report
