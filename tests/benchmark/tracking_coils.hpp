// Tubes wound up so that their turns touch and sway against each other: one that is reported, and another one that
// settings are chosen on.
#pragma once

#include <cstddef>
#include <string>

#include "tracking_scenes.hpp"

namespace grapeshot::bench {

/// Of the turns: height * sin(perTurn * angle along the coil + speed * phase).
struct CoilWave {
    float height;  ///< m
    float perTurn, speed;
};

struct CoilShape {
    float tubeRadius, turnRadius, length;  ///< m
    float bump, bumpAlong, bumpAround;     ///< share of the radius; 1/m; per turn of the tube
    float phase;                           ///< rad per frame
    float breath, breathPhase;             ///< share of the pitch; rad per frame
    CoilWave sway, lift;                   ///< outwards and along the axis
    float maxDistance, spacing;            ///< m
};

/// The spacing follows from what was chosen on the other one.
inline constexpr CoilShape reportedCoil{.tubeRadius = 0.02F,
                                        .turnRadius = 0.15F,
                                        .length = 3.93F,
                                        .bump = 0.04F,
                                        .bumpAlong = 40,
                                        .bumpAround = 3,
                                        .phase = 0.12F,
                                        .breath = 0.04F,
                                        .breathPhase = 0.05F,
                                        .sway = {0.006F, 2.5F, 1},
                                        .lift = {0.004F, 3.5F, -0.7F},
                                        .maxDistance = 0.002F,
                                        .spacing = 1.25F * 0.02F};
/// Thicker, in narrower turns, with other bumps and waves.
inline constexpr CoilShape fittingCoil{.tubeRadius = 0.025F,
                                       .turnRadius = 0.13F,
                                       .length = 3.4F,
                                       .bump = 0.05F,
                                       .bumpAlong = 31,
                                       .bumpAround = 2,
                                       .phase = 0.15F,
                                       .breath = 0.05F,
                                       .breathPhase = 0.07F,
                                       .sway = {0.007F, 1.5F, -1},
                                       .lift = {0.004F, 4.5F, 0.6F},
                                       .maxDistance = 0.0022F,
                                       .spacing = 1.25F * 0.025F};

/// So many units for the length of a tube radius, whatever the number of triangles: a twelfth more than where the worst
/// of six seeds covers 99.5 % of the fitting coil of 100k triangles; looking ahead by 2 steps, at which it covers more
/// in the same time than at 0 and 1 (see tracking_fit.hpp).
[[nodiscard]] constexpr TrackingBudget coilBudget(const CoilShape& shape) {
    constexpr float unitsPerRadius = 26;
    return {static_cast<std::uint64_t>(unitsPerRadius * shape.length / shape.tubeRadius), 64, 0.1F, 2};
}

/// Straight at rest. About `triangles` triangles.
[[nodiscard]] TrackingScene coil(const std::string& name, const CoilShape& shape, std::size_t triangles);
[[nodiscard]] TrackingFrame coilAt(const TrackingScene& scene, const CoilShape& shape, float frame);

}  // namespace grapeshot::bench
