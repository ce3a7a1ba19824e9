// Which active pairs collide, and what lies around them.
//
// This work is based on:
// Laks Raghupathi et al. An Intestinal Surgery Simulator. TVCG 10(6), 2004 (the recursive search on a hit)
#pragma once

#include <vector>

#include <grapeshot/scf/reference/active_pairs.hpp>
#include <grapeshot/scf/reference/detail/placed_surface.hpp>

namespace grapeshot::scf::reference::detail {

/// By triangles, each pair once.
[[nodiscard]] std::vector<Contact> collisions(const PlacedSurface& a, const PlacedSurface& b, const Settings& settings,
                                              const std::vector<ActivePair>& pairs, Work& work);

}  // namespace grapeshot::scf::reference::detail
