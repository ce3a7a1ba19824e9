#include "trial.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace grapeshot::import::detail {
namespace {

constexpr int threw = 3;

void limit(int resource, rlim_t most) {
    const rlimit value{most, most};
    setrlimit(static_cast<__rlimit_resource>(resource), &value);
}

[[noreturn]] void runChild(const std::function<void()>& work, const TrialLimits& limits) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpuTime.count()));
#ifndef __SANITIZE_ADDRESS__  // whose shadow memory is larger than any limit
    limit(RLIMIT_AS, limits.maxMemory);
#endif
    try {
        work();
    } catch (...) {
        _exit(threw);
    }
    _exit(0);
}

}  // namespace

std::string tryInChild(const std::function<void()>& work, const TrialLimits& limits) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) {
        return std::string("no process: ") + std::strerror(errno);
    }
    if (child == 0) {
        runChild(work, limits);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) {
            return std::string("lost its process: ") + std::strerror(errno);
        }
    }
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        return signal == SIGXCPU || signal == SIGKILL ? "ran out of time or memory"
                                                      : std::string("crashed: ") + strsignal(signal);
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : "failed";
}

}  // namespace grapeshot::import::detail
