// How the two bodies of a pair move in the coming step.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btTransform.h>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Of a collision object, world frame. Rigid bodies: their velocities as the step begins; the interpolation's are one
/// step old, and zero for a body that was just thrown. Links of multibodies: by the rates of the joints that carry
/// them, O(joints). Others: the interpolation's. Static ones: none.
struct Motion {
    btVector3 velocity{0, 0, 0};  ///< of the centre of mass, m/s
    btVector3 spin{0, 0, 0};      ///< rad/s
};
[[nodiscard]] Motion motionOf(const btCollisionObject& object);

/// Where a collision object will be after `seconds`.
[[nodiscard]] btTransform predicted(const btCollisionObject& object, const Motion& motion, btScalar seconds);
/// Where the wrapped shape will be after `seconds`: a child turns about its body's centre of mass.
[[nodiscard]] btTransform predicted(const btCollisionObjectWrapper& wrap, const Motion& motion, btScalar seconds);

/// How far two shapes (of the given radii about their own origins, m) can come nearer to each other in `seconds`, m.
[[nodiscard]] btScalar approachBound(const btCollisionObjectWrapper& a, btScalar radiusA,
                                     const btCollisionObjectWrapper& b, btScalar radiusB, btScalar seconds);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
