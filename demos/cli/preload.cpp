// `grapeshot preload -- PROGRAM ARGUMENTS...`: a program that was compiled without us, with our contacts.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/preload/take_over.hpp>

#include "commands.hpp"

namespace grapeshot::cli {
namespace {

struct PreloadOptions {
    std::string logFile;
    std::uint64_t budget = 0;
    bool exact = false;
    std::vector<std::string> program;
};

/// Beside the tool, where it was built or where it was installed.
std::filesystem::path findLibrary() {
    const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    for (const char* place : {GRAPESHOT_PRELOAD_PLACES}) {
        const std::filesystem::path library = folder / place / "libgrapeshot-preload.so";
        if (std::filesystem::exists(library)) {
            const std::filesystem::path found = std::filesystem::canonical(library);
            if (found.string().find_first_of(" :") != std::string::npos) {
                throw Error(Fault::badFile, "the loader takes no path with a space or a colon", found.string());
            }
            return found;
        }
    }
    throw Error(Fault::badFile, "not found beside the tool", "libgrapeshot-preload.so");
}

/// A program may have been started by another that was; its settings are not this one's.
void set(const char* variable, const std::string& value) {
    value.empty() ? unsetenv(variable) : setenv(variable, value.c_str(), 1);
}

ExitCode runPreloaded(const PreloadOptions& options) {
    std::string libraries = findLibrary().string();
    if (const char* others = std::getenv("LD_PRELOAD"); others != nullptr && *others != '\0') {
        libraries += std::string(":") + others;
    }
    setenv("LD_PRELOAD", libraries.c_str(), 1);
    // The program may change its folder.
    set(preload::logVariable, options.logFile.empty() ? "" : std::filesystem::absolute(options.logFile).string());
    set(preload::budgetVariable, options.budget > 0 ? std::to_string(options.budget) : "");
    set(preload::exactVariable, options.exact ? "1" : "");
    set(preload::processVariable, std::to_string(getpid()));
    std::vector<char*> arguments;
    for (const std::string& argument : options.program) {
        arguments.push_back(const_cast<char*>(argument.c_str()));
    }
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    std::fprintf(stderr, "grapeshot: %s: %s\n", arguments[0], std::strerror(errno));
    return badUse;
}

}  // namespace

void addPreload(CLI::App& tool, std::function<ExitCode()>& run) {
    auto* command = tool.add_subcommand(
        "preload", "Runs a program that was compiled with a shared Bullet 3.24, with our contacts in place of its own");
    auto options = std::make_shared<PreloadOptions>();
    command->add_option("--log", options->logFile, "append the report of what was taken over (else standard error)");
    command->add_option("--pair-budget", options->budget, "work units a pair and step (else unlimited)")
        ->check(CLI::PositiveNumber);
    command->add_flag("--exact", options->exact, "the exact settings");
    command->add_option("PROGRAM", options->program, "the program and its arguments, after --")
        ->required()
        ->expected(1, -1);
    command->positionals_at_end();
    command->callback([options, &run] { run = [options] { return runPreloaded(*options); }; });
}

}  // namespace grapeshot::cli
