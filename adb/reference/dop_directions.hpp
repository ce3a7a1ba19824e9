// The fixed directions of k-DOPs, and any other direction as a sum of three of them.
#pragma once

#include <Eigen/Core>
#include <array>

namespace grapeshot::reference {

/// Unit vectors: 3 to the faces, 6 to the edges, 4 to the corners of a cube. An 18-DOP uses the first 9, a 26-DOP all.
[[nodiscard]] const std::array<Eigen::Vector3d, 13>& dopDirections();

/// direction = sum of weight[i] * dopDirections()[axis[i]]; weights may be negative, for the opposite half-space.
struct DopCone {
    std::array<int, 3> axis;
    std::array<double, 3> weight;
};

/// The three that surround the direction (of about unit length). The support function of a polytope is at most the same
/// combination of its slabs, so the slab that follows is never too small; and of all threes this one has the least sum
/// of magnitudes, so it is the tightest for a ball.
[[nodiscard]] DopCone dopCone(int k, const Eigen::Vector3d& direction);

}  // namespace grapeshot::reference
