// Sheets and a garment on bodies that are not convex.
#pragma once

#include <soft/demo.hpp>

namespace grapeshot::cloth {

struct ClothSettings {
    int nodes = 25;  ///< along an edge of a sheet, or around the garment: 9 to 300
};

/// A sheet falls on a torus of 1 m.
[[nodiscard]] soft::Scene overTorus(soft::Method method, const ClothSettings& settings,
                                    const soft::DemoOptions& options);
/// A sheet falls on the teeth of a comb.
[[nodiscard]] soft::Scene overComb(soft::Method method, const ClothSettings& settings,
                                   const soft::DemoOptions& options);
/// A sheet falls on the edges of upright blades.
[[nodiscard]] soft::Scene overBlades(soft::Method method, const ClothSettings& settings,
                                     const soft::DemoOptions& options);
/// A tube of cloth around a waisted body that turns and sways.
[[nodiscard]] soft::Scene garment(soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options);

}  // namespace grapeshot::cloth
