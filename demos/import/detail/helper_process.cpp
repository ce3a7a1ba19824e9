#include "helper_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <thread>

namespace grapeshot::import::detail {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int startFailed = 127;  // exit code of a child that could not become the program

void limit(decltype(RLIMIT_AS) resource, rlim_t soft, rlim_t hard) {
    const rlimit value{soft, hard};
    if (setrlimit(resource, &value) != 0) {
        _exit(startFailed);  // never without the limit
    }
}

// Between fork and exec: only calls that are safe in the copy of a program with threads.
[[noreturn]] void becomeProgram(const char* program, char* const* arguments, int output, const ProcessLimits& limits) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    for (const int which : {SIGPIPE, SIGXCPU, SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) {
        std::signal(which, SIG_DFL);
    }
    // A parent without standard streams has the pipe at 0..2: out of the way before those are set.
    output = fcntl(output, F_DUPFD, STDERR_FILENO + 1);
    const int null = open("/dev/null", O_RDWR);
    if (output < 0 || null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(null, STDERR_FILENO) < 0 ||
        dup2(output, STDOUT_FILENO) < 0) {
        _exit(startFailed);
    }
    close_range(STDERR_FILENO + 1, ~0U, 0);
    const auto seconds = static_cast<rlim_t>(std::max<std::chrono::seconds::rep>(1, limits.cpuTime.count()));
    limit(RLIMIT_CORE, 0, 0);
    limit(RLIMIT_CPU, seconds, seconds + 1);
    limit(RLIMIT_AS, limits.maxMemory, limits.maxMemory);
    execv(program, arguments);
    _exit(startFailed);
}

// True at the end of the output, false if time or size ran out (then `result.end` says which).
bool collect(int pipe, Clock::time_point deadline, std::size_t maxOutput, ProcessResult& result) {
    constexpr std::size_t chunk = 1U << 16U;
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        pollfd waiting{pipe, POLLIN, 0};
        const int ready = left > 0 ? poll(&waiting, 1, static_cast<int>(std::min<long>(left, 1'000'000))) : 0;
        if (ready < 0 && errno == EINTR) {
            continue;
        }
        if (ready == 0 && Clock::now() < deadline) {
            continue;
        }
        if (ready <= 0) {
            result.end = ProcessEnd::wallTimeUp;
            return false;
        }
        const std::size_t have = result.output.size();
        result.output.resize(have + chunk);
        const ssize_t got = read(pipe, result.output.data() + have, chunk);
        result.output.resize(have + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return true;
        }
        if (result.output.size() > maxOutput) {
            result.end = ProcessEnd::tooMuchOutput;
            return false;
        }
    }
}

// A child that has closed its output may still run: waits for it until the deadline, looking every millisecond.
bool reap(pid_t child, Clock::time_point deadline, int& status) {
    for (;;) {
        const pid_t got = waitpid(child, &status, WNOHANG);
        if (got == child) {
            return true;
        }
        if (got < 0 && errno != EINTR) {
            status = 0;  // somebody else reaped it (SIGCHLD ignored): the message alone must tell
            return true;
        }
        if (Clock::now() >= deadline) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace

ProcessResult runLimited(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const ProcessLimits& limits) {
    ProcessResult result;
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);

    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        result.code = errno;
        return result;
    }
    const Clock::time_point deadline = Clock::now() + limits.wallTime;
    const pid_t child = fork();
    if (child == 0) {
        becomeProgram(argv[0], argv.data(), ends[1], limits);
    }
    result.code = errno;
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        return result;
    }

    int status = 0;
    bool ended = collect(ends[0], deadline, limits.maxOutput, result);
    close(ends[0]);
    if (ended && !reap(child, deadline, status)) {
        result.end = ProcessEnd::wallTimeUp;
        ended = false;
    }
    if (!ended) {
        kill(child, SIGKILL);
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
        return result;
    }
    if (WIFSIGNALED(status)) {
        result.code = WTERMSIG(status);
        // SIGKILL comes from the kernel too, a second after a SIGXCPU that was ignored.
        result.end = result.code == SIGXCPU ? ProcessEnd::cpuTimeUp : ProcessEnd::signalled;
        return result;
    }
    result.code = WEXITSTATUS(status);
    result.end = ProcessEnd::exited;
    if (result.code == startFailed && result.output.empty()) {
        result.code = ENOEXEC;
        result.end = ProcessEnd::notStarted;
    }
    return result;
}

}  // namespace grapeshot::import::detail
