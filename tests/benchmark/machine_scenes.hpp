// Things that only work if concave bodies touch where they do: chains, nested cups, gears, an arch.
#pragma once

#include <span>
#include <string_view>

#include <scenes/world.hpp>

namespace grapeshot::bench {

struct MachineScene {
    std::string_view name;
    double seconds;
    /// @param method what it is run by; margin and what else the scene needs are set here
    scenes::World (*make)(scenes::WorldSettings method, double margin);
    std::string_view fault;                     ///< what `faults` counts
    int (*faults)(const scenes::World& world);  ///< after the run
};

[[nodiscard]] std::span<const MachineScene> machineScenes();

}  // namespace grapeshot::bench
