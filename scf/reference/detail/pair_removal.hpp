// Which pairs are not worth following.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004 (the distance: 1.2 times the
// smallest and 1 % of the size)
#pragma once

#include <cstddef>
#include <vector>

#include <grapeshot/scf/reference/active_pairs.hpp>

namespace grapeshot::scf::reference::detail {

/// Of equal pairs the oldest stays, of neighbouring ones the closest. Returns how many went.
std::size_t removeRedundant(const Surface& a, const Surface& b, Redundancy redundancy, std::vector<ActivePair>& pairs);

/// By distance, and the farthest beyond `mostPairs`. `size` in m. Returns how many went.
std::size_t removeFar(float size, const Settings& settings, std::vector<ActivePair>& pairs);

}  // namespace grapeshot::scf::reference::detail
