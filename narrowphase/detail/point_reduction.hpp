// Which few of a region's contacts carry the body: the deepest, and the widest support under it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include <grapeshot/narrowphase/contact_set.hpp>

namespace grapeshot::detail {

struct ReductionCandidate {
    Eigen::Vector3f onA;
    float u, v;  ///< place in the plane across the region's normal, m
    float signedDistance;
    bool kept;  ///< in the set already
};

struct Reduction {
    int count = 0;
    std::array<int, maxPointsPerRegion> chosen{};  ///< indices of candidates, kept ones first, each in ascending order
};

/// Kept candidates win unless a new one is clearly better: deeper than all chosen by a tenth of mergeDistance, or
/// enlarging the spread by 15 % in place of a kept one (10 % as an addition). No two are nearer than mergeDistance on
/// A. Spread of a set: area of its convex hull in the plane, widened by mergeDistance / 2, so that points on a line
/// count by their length.
[[nodiscard]] Reduction reducePoints(std::span<const ReductionCandidate> candidates, float mergeDistance);

}  // namespace grapeshot::detail
