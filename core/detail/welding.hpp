// Vertices at exactly the same position are one vertex, whatever the loader says.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace grapeshot::detail {

/// Per vertex the lowest index among those at its position (0 and -0 are the same place). A vertex that is not finite
/// stands for itself. O(n) expected.
[[nodiscard]] std::vector<std::uint32_t> weld(std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot::detail
