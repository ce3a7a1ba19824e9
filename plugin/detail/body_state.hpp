// What of a body changes from step to step.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <grapeshot/plugin/detail/bullet_bytes.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct BodyState {
    // What it is, to be compared.
    int shapeType = 0;
    int flags = 0;
    bool isRigidBody = false;
    // What it does.
    btTransform pose, interpolation;
    btVector3 interpolationVelocity{0, 0, 0}, interpolationSpin{0, 0, 0};
    int activation = 0;
    btScalar deactivationTime = 0;                                                ///< s
    btVector3 velocity{0, 0, 0}, spin{0, 0, 0}, force{0, 0, 0}, torque{0, 0, 0};  ///< of rigid bodies
};

[[nodiscard]] BodyState stateOf(const btCollisionObject& object);
/// Same kind of body with the same kind of shape?
[[nodiscard]] bool fits(const BodyState& state, const btCollisionObject& object);
void apply(const BodyState& state, btCollisionObject& object);

void save(const BodyState& state, ByteWriter& out);
/// @throws Error badFile
[[nodiscard]] BodyState loadBodyState(ByteReader& in);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
