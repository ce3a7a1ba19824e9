// Makes a btPersistentManifold hold exactly the given points, so that those that persist keep their impulses.
//
// Bullet's own cache takes two points within the breaking threshold on the first body for one and the same, whatever
// their normals and their places on the second; for thin parts and for contacts ahead of time (whose threshold is
// large) that is wrong. But only btManifoldResult::addContactPoint sets friction and restitution, calls the program's
// callbacks and answers queries. So each point goes through it, while the others are out of its sight.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <span>

#include <grapeshot/plugin/detail/triangle_in_place.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// A contact as Bullet wants it, in the order of the manifold's bodies: A is its body 0.
struct BulletPoint {
    btVector3 position;  ///< on B, world frame
    btVector3 normal;    ///< on B pointing to A, world frame, unit
    btScalar depth = 0;  ///< negative: penetration
    btVector3 localA;    ///< where Bullet will keep it: frames of the collision objects
    btVector3 localB;
    TriangleId triangleA;  ///< index -1: no mesh
    TriangleId triangleB;
    TriangleFace faceA, faceB;
};

inline constexpr bool goesOn = false;

/// At most MANIFOLD_CACHE_SIZE points. A kept point goes on as the new one that is nearest on either body, if that is
/// within `reach`, m. Ends as soon as a callback of the program's has made `stopped` true.
void setPoints(btPersistentManifold& manifold, std::span<const BulletPoint> points, btScalar reach,
               btManifoldResult& result, const bool& stopped = goesOn);

/// One point, by Bullet's own rules.
void addPoint(btPersistentManifold& manifold, const BulletPoint& point, btManifoldResult& result);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
