// Where new pairs come from.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004 (at random, where it moves fast)
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
// (random pairs in the regions that an incomplete hierarchy finds interesting)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/reference/detail/local_search.hpp>

namespace grapeshot::scf::reference::detail {

/// Where both bodies were a step ago; empty: nothing is known of their motion.
struct Before {
    std::span<const Eigen::Vector3f> a, b;
};

struct Created {
    std::vector<FeaturePair> pairs;
    std::size_t regions = 0;  ///< pairs of nodes that the hierarchy proposed
    std::size_t boxTests = 0;
};

/// `newPairs` of them, not yet searched from. A function of `key` and the arguments alone.
[[nodiscard]] Created createPairs(const PlacedSurface& a, const PlacedSurface& b, const Before& before,
                                  const Settings& settings, const RandomKey& key);

}  // namespace grapeshot::scf::reference::detail
