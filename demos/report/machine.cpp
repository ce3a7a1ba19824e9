#include <report/machine.hpp>

#include <ctime>
#include <fstream>

#include <grapeshot/core/instruction_set.hpp>

#include "commit.hpp"

namespace grapeshot::report {

namespace {

std::string cpuName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name")) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown";
}

double readUs(clockid_t clock) noexcept {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

}  // namespace

Machine machine() {
#if defined(__clang__)
    const std::string compiler = "clang " __clang_version__;
#else
    const std::string compiler = "g++ " __VERSION__;
#endif
    return {sourceCommit, cpuName(), std::string(name(instructionSet())), compiler};
}

double threadCpuUs() noexcept {
    return readUs(CLOCK_THREAD_CPUTIME_ID);
}

double wallUs() noexcept {
    return readUs(CLOCK_MONOTONIC);
}

}  // namespace grapeshot::report
