// Runs a program that is not trusted to end, and collects what it says.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace grapeshot::import::detail {

struct ProcessLimits {
    std::size_t maxMemory = 0;  ///< bytes of address space
    std::chrono::seconds cpuTime{0};
    std::chrono::milliseconds wallTime{0};
    std::size_t maxOutput = 0;  ///< bytes of standard output
};

enum class ProcessEnd {
    exited,         ///< `code` is the exit code
    signalled,      ///< `code` is the signal
    cpuTimeUp,      ///< ended by the kernel for its processor time
    wallTimeUp,     ///< ended by us
    tooMuchOutput,  ///< ended by us
    notStarted,     ///< `code` is errno
};

struct ProcessResult {
    ProcessEnd end = ProcessEnd::notStarted;
    int code = 0;
    std::vector<std::byte> output;
};

/// Standard input and error are /dev/null; no other descriptor is handed on; the child dies with its parent's thread.
[[nodiscard]] ProcessResult runLimited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                       const ProcessLimits& limits);

}  // namespace grapeshot::import::detail
