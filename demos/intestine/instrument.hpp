// A surgeon's hook, and the way it goes: down between two strands, aside, up, back down, out.
#pragma once

#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>

namespace grapeshot::intestine {

/// A bent rod, closed and not convex: the shaft along +y, at its foot a half circle to +x that ends pointing up.
/// @param around vertices around the rod
[[nodiscard]] scenes::Mesh hook(int around);

struct Operation {
    Eigen::Vector3d spot = Eigen::Vector3d::Zero();    ///< where the hook's lowest point dips in, world frame, m
    Eigen::Vector3d aside = Eigen::Vector3d::UnitX();  ///< unit, horizontal: to the strand that it takes
};

/// Where the hook is. @param progress 0 to 1 through the whole operation; still and far above until `begin`
[[nodiscard]] scenes::PoseD instrumentPose(double progress, const Operation& operation);
constexpr double begin = 0.25;

}  // namespace grapeshot::intestine
