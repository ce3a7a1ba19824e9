// The scenes that every Method has to run: piles, shots, machines, and bodies that jam in each other.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <scenes/world.hpp>

#include "options.hpp"

namespace grapeshot::bench {

struct MethodScene {
    std::string name;
    double seconds = 4;
    double timeStep = 1.0 / 60;  ///< s
    double frameSeconds = 0.5;   ///< between the poses of which the true penetration is taken
    bool rests = false;          ///< moves no more at the end, sleeping or not
    bool isTangled = false;      ///< much of the surfaces touches: too much for a sample in a quick run
    std::function<scenes::World(const scenes::WorldSettings&)> make;
    std::string fault = {};                                      ///< what `faults` counts
    std::function<int(const scenes::World& world)> faults = {};  ///< after the run; may be empty
};

[[nodiscard]] std::vector<MethodScene> methodScenes(const Options& options);

}  // namespace grapeshot::bench
