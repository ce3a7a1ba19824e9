// What a step is told of a surface, checked: its vertices, its triangles, its stretch.
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <span>

#include <grapeshot/scf/stretch.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot::detail {

/// Are the positions as many as the surface has vertices, and the triangles its own? Of what is empty it is not asked.
[[nodiscard]] bool isOfSurface(const Surface& surface,
                               std::initializer_list<std::span<const Eigen::Vector3f>> positions,
                               std::span<const Triangle> triangles);

[[nodiscard]] bool isUsable(const Stretch& stretch);
[[nodiscard]] bool isUsable(const Displacement& displacement);

/// The bound to make the balls with for all of these positions, empty ones at rest; 0 if the balls are to be fitted;
/// NaN if it had to be measured and a position is not finite.
[[nodiscard]] float stretchToUse(const Stretch& stretch, const Surface& surface,
                                 std::initializer_list<std::span<const Eigen::Vector3f>> positions);

}  // namespace grapeshot::detail
