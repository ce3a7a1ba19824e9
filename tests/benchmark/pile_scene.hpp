// Non-convex bodies dropped into a pit.
#pragma once

#include <cstdint>

#include <scenes/world.hpp>

namespace grapeshot::bench {

enum class PileFloor {
    mesh,  ///< an open triangle mesh
    box,   ///< a box of Bullet's own
};

struct PileSettings {
    int bodies = 50;
    int trianglesPerBody = 5000;  ///< about
    double margin = 0.02;         ///< m
    PileFloor floor = PileFloor::mesh;
    std::uint64_t seed = 1;
};

inline constexpr double pileRadius = 1;  ///< of the ball around each body, m

/// Four box walls around a floor; five kinds of bodies, in layers of nine above each other, turned at random. A body is
/// lost if its centre leaves the pit, e.g. through the floor.
/// @param method what it is run by; margin and bounds of the world are the scene's
[[nodiscard]] scenes::World makePile(scenes::WorldSettings method, const PileSettings& settings);

}  // namespace grapeshot::bench
