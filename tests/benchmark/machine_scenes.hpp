// Things that only work if concave bodies touch where they do: chains, nested cups, gears, an arch; and a pair at the
// rate of haptics.
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

inline constexpr double hapticTimeStep = 1e-3;  ///< s
/// Of each of its two meshes.
[[nodiscard]] constexpr int hapticTriangles(bool quick) {
    return quick ? 2000 : 20000;
}
/// A spiked ball that slides on a bumpy one that is held, a step per millisecond.
[[nodiscard]] scenes::World makeHapticPair(scenes::WorldSettings method, double margin, int triangles);

}  // namespace grapeshot::bench
