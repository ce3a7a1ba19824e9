// The subcommands of the tool `grapeshot`.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace grapeshot::cli {

/// Exit codes: 0 done, 1 a claim failed, 2 bad use or input that cannot be read.
enum ExitCode : int { done = 0, claimFailed = 1, badUse = 2 };

/// Adds a subcommand to the tool; if it is the one that was asked for, `run` becomes what it does.
void addInspect(CLI::App& tool, std::function<ExitCode()>& run);
void addCompare(CLI::App& tool, std::function<ExitCode()>& run);
void addRun(CLI::App& tool, std::function<ExitCode()>& run);
void addScene(CLI::App& tool, std::function<ExitCode()>& run);
void addPreload(CLI::App& tool, std::function<ExitCode()>& run);

}  // namespace grapeshot::cli
