// Who finds a scene's contacts, on which shapes, how often, and for how much work: ours and the peers.
#pragma once

#include <cstdint>
#include <string>

#include <scenes/world.hpp>

#include "hull_compound.hpp"

namespace grapeshot::bench {

struct SceneMethod {
    std::string name;
    scenes::WorldSettings world;  ///< what the method decides: engine, its settings, stand-in, time step
    int runs = 1;                 ///< of the same scene; of times each step's least counts
};

[[nodiscard]] SceneMethod grapeshotMethod(int runs);
[[nodiscard]] SceneMethod gimpactMethod();
/// The convex hull of each mesh.
[[nodiscard]] SceneMethod hullMethod(int runs);
/// Bullet's own compounds of the hulls of an approximate convex decomposition; each mesh is decomposed once.
[[nodiscard]] SceneMethod hacdMethod(int runs, const HullSettings& settings = {});
/// Our engine on meshes of about so many triangles.
[[nodiscard]] SceneMethod decimatedMethod(int runs, std::size_t triangles);

/// The same with a budget for each step, work units.
[[nodiscard]] SceneMethod budgeted(SceneMethod method, std::uint64_t work);
/// Half as many steps of twice the length. A budget stays what it is: of a step.
[[nodiscard]] SceneMethod halvedRate(SceneMethod method);
/// Plain round robin: no budget for the step, the same most work for every pair in it, whatever the pair is.
[[nodiscard]] SceneMethod roundRobin(int runs, std::uint64_t workOfPair);

}  // namespace grapeshot::bench
