// Surfaces swept out by a curve: tubes closed both ways, and solids of revolution.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include <scenes/shapes.hpp>

namespace grapeshot::scenes::detail {

/// A torus-like surface of around x across vertices; both indices wrap. Outward if (d/d around) x (d/d across) is.
Mesh closedTube(int around, int across, const std::function<Eigen::Vector3d(int, int)>& position);

/// The profile (radius, height) turned about the y axis; its first and last point lie on the axis, it runs
/// counter-clockwise seen with the radius to the right and the height up.
Mesh revolved(const std::vector<Eigen::Vector2d>& profile, int around);

}  // namespace grapeshot::scenes::detail
