// `grapeshot`: the tool.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include <grapeshot/core/instruction_set.hpp>

#include "commands.hpp"

namespace {

using namespace grapeshot;

int runTool(int argc, char** argv) {
    CLI::App tool("Approximate, time-critical collision detection: looks at meshes, compares them, runs scenes.",
                  "grapeshot");
    tool.require_subcommand(1);
    tool.set_version_flag("--version",
                          "grapeshot " GRAPESHOT_VERSION " (kernels: " + std::string(name(instructionSet())) + ")");
    std::function<cli::ExitCode()> run;
    cli::addInspect(tool, run);
    cli::addCompare(tool, run);
    cli::addRun(tool, run);
    cli::addScene(tool, run);
    cli::addPreload(tool, run);
    try {
        tool.parse(argc, argv);
    } catch (const CLI::ParseError& end) {
        // Help and version end in a ParseError too, with code 0.
        return tool.exit(end) == 0 ? cli::done : cli::badUse;
    }
    return run();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return runTool(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "grapeshot: %s\n", error.what());
        return cli::badUse;
    }
}
