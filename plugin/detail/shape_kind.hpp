// Which shapes are whose.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <grapeshot/plugin/settings.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// A triangle mesh that we read: GImpact mesh or part, BVH mesh, scaled or multi-material BVH mesh, height field.
[[nodiscard]] bool isMesh(const btCollisionShape& shape);
/// One of GImpact's kinds, compound included.
[[nodiscard]] bool isGImpact(const btCollisionShape& shape);
[[nodiscard]] bool isGImpactCompound(const btCollisionShape& shape);
/// A plane or a convex shape, by its type.
[[nodiscard]] bool isSolidType(int shapeType);
[[nodiscard]] bool isSolid(const btCollisionShape& shape);

enum class PairKind {
    foreign,  ///< not ours
    meshMesh,
    meshSolid,  ///< the mesh is the first body
    solidMesh,
};

/// Against a plane only GImpact's meshes have an algorithm of Bullet's; other meshes have one against convex shapes.
/// See Settings::convexPairs and bvhConvexPairs.
[[nodiscard]] PairKind kindOf(const btCollisionShape& first, const btCollisionShape& second, const Settings& settings);

/// Distance that a mesh keeps from others, m; never negative or NaN. A GImpact mesh keeps its margin in its parts: its
/// own is that of a concave shape, 0, unless it was set through the mesh.
[[nodiscard]] btScalar marginOf(const btCollisionShape& mesh);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
