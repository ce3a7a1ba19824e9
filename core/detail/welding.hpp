// Vertices at exactly the same position are one vertex, whatever the loader says.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// Per vertex the lowest index among those at its position (0 and -0 are the same place). A vertex that is not finite
/// stands for itself. O(n) expected.
Sliced weldInSlices(std::span<const Eigen::Vector3f> vertices, std::vector<std::uint32_t>& welded);

}  // namespace grapeshot::detail
