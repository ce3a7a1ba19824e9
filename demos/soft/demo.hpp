// What soft demos have in common: options, running a scene with two methods in turns, judging, pictures, numbers.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <report/report.hpp>
#include <scenes/picture.hpp>

#include "soft_world.hpp"

namespace grapeshot::soft {

struct DemoOptions {
    std::uint64_t seed = 1;
    int steps = 600;
    int stop = 0;     ///< > 0: end after so many of them
    int judged = 15;  ///< steps from one look of the judge to the next
    bool progress = false;
    std::filesystem::path json;
    std::filesystem::path pictures;
    std::string against = "none";
};
void addOptions(CLI::App& app, DemoOptions& options);

struct Scene {
    std::string name;
    std::unique_ptr<World> world;
    scenes::Camera camera;
    std::function<void(int)> beforeStep;  ///< of that number, from 0; may be empty
    /// What the scene itself can tell is wrong after each step: may be empty. Counts add up over the steps.
    std::function<std::size_t()> wrong;
    std::string wrongName;             ///< of what it counts
    double apart = 0;                  ///< m, > 0: what was farther from each other at rest is counted by itself
    std::size_t toleratedTangle = 0;   ///< crossings of the soft bodies with each other at the end, edges
    std::size_t toleratedPierced = 0;  ///< the same with rigid meshes
};
using SceneMaker = std::function<Scene(Method)>;

/// Runs every scene; writes what the options ask for. Returns the exit code: 0, or 1 if a claim about our own methods
/// does not hold.
int demo(const std::string& suite, const DemoOptions& options, const std::vector<SceneMaker>& makers);

/// `main` of a demo: parses, calls `body`, and says what went wrong. 0, 1 (as `body` says), 2 (bad use, errors).
int runMain(CLI::App& app, int argc, char** argv, const std::function<int()>& body);

}  // namespace grapeshot::soft
