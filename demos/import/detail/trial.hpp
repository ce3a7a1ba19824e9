// Something that may crash, done in a child process first.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace grapeshot::import::detail {

struct TrialLimits {
    std::size_t maxMemory = std::size_t{4} << 30U;  ///< bytes of address space
    std::chrono::seconds cpuTime{60};
};

/// Runs `work` in a copy of this process (fork), without its output. Empty if it came back; else how it ended. Not when
/// other threads hold locks that `work` takes.
[[nodiscard]] std::string tryInChild(const std::function<void()>& work, const TrialLimits& limits = {});

}  // namespace grapeshot::import::detail
