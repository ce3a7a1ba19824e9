// The point of a surface nearest to a convex shape, by Bullet's GJK on the triangles that may have it.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct ClosestToConvex {
    bool found = false;
    std::uint32_t triangle = 0;
    float distance = 0;  ///< m; 0: they intersect
    Eigen::Vector3f onSurface = Eigen::Vector3f::Zero(), onConvex = Eigen::Vector3f::Zero();
};

/// Everything in the frame of the positions. The margin is part of the convex shape. O(triangles); GJK for those whose
/// boxes are nearer than what was found. Threads (see SoftSurface) are triangles like others.
[[nodiscard]] ClosestToConvex closestToConvex(std::span<const Eigen::Vector3f> positions,
                                              std::span<const Triangle> triangles, const btConvexShape& convex,
                                              const btTransform& pose, float maxDistance);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
