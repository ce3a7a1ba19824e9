// Fifty non-convex bodies dropped into a pit.
#pragma once

#include <cstdint>

#include <scenes/world.hpp>

namespace grapeshot::bench {

struct PileSettings {
    int bodies = 50;
    int trianglesPerBody = 5000;  ///< about
    double margin = 0.02;         ///< m
    std::uint64_t seed = 1;
};

inline constexpr double pileRadius = 1;  ///< of the ball around each body, m

/// Four box walls around a floor that is an open triangle mesh; five kinds of bodies, in layers of nine above each
/// other, turned at random. A body is lost if its centre leaves the pit, e.g. through the floor.
[[nodiscard]] scenes::World makePile(scenes::Engine engine, const PileSettings& settings);

}  // namespace grapeshot::bench
