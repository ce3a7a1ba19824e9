// How close two features' triangles come, exactly.
#pragma once

#include <cstddef>
#include <cstdint>

#include <grapeshot/scf/reference/detail/placed_surface.hpp>

namespace grapeshot::scf::reference::detail {

struct FanDistance {
    float distance = 0;  ///< m; 0 if they intersect
    std::uint32_t triangleA = 0;
    std::uint32_t triangleB = 0;
};

/// All triangles around one level-0 feature against all around the other, about 36 pairs; adds them to `pairs`.
[[nodiscard]] FanDistance fanDistance(const PlacedSurface& a, std::uint32_t featureA, const PlacedSurface& b,
                                      std::uint32_t featureB, std::size_t& pairs);

}  // namespace grapeshot::scf::reference::detail
