// A fast rigid body goes no farther in a step than a soft one makes way.
//
// In btSoftRigidDynamicsWorld rigid bodies are moved before soft bodies are solved: at 30 m/s one is half a metre
// behind a sheet before the sheet knows, and links draw the sheet back faster than contacts push it. So the body keeps
// the speed that it can go at: as of a soft body's nodes, its velocity is the way that is left, by the time. What it
// loses beyond what its contacts take is gone.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>

#include <span>

#include <grapeshot/plugin/detail/surface_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct RigidWay {
    btTransform from, to;  ///< of the mesh, in the world; contacts are in the frame of `to`
    float distance = 0;  ///< margins of both, m: it may go half of that into them, and what is slower is not looked at
};

/// The share of its way that the body may go, 0..1. O(contacts).
[[nodiscard]] btScalar shareOfWay(const RigidWay& way, const SurfaceInStep& rigid,
                                  std::span<const SoftSurfaceContact> contacts);
/// Of a rigid body that moves by itself; others go on.
void slowDown(const btCollisionObject& object, btScalar share);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
