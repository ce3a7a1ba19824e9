#include <grapeshot/plugin/detail/body_state.hpp>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

BodyState stateOf(const btCollisionObject& object) {
    BodyState state;
    state.shapeType = object.getCollisionShape()->getShapeType();
    state.flags = object.getCollisionFlags();
    state.pose = object.getWorldTransform();
    state.interpolation = object.getInterpolationWorldTransform();
    state.interpolationVelocity = object.getInterpolationLinearVelocity();
    state.interpolationSpin = object.getInterpolationAngularVelocity();
    state.activation = object.getActivationState();
    state.deactivationTime = object.getDeactivationTime();
    if (const btRigidBody* body = btRigidBody::upcast(&object)) {
        state.isRigidBody = true;
        state.velocity = body->getLinearVelocity();
        state.spin = body->getAngularVelocity();
        state.force = body->getTotalForce();
        state.torque = body->getTotalTorque();
    }
    return state;
}

bool fits(const BodyState& state, const btCollisionObject& object) {
    return state.shapeType == object.getCollisionShape()->getShapeType() && state.flags == object.getCollisionFlags() &&
           state.isRigidBody == (btRigidBody::upcast(&object) != nullptr);
}

void apply(const BodyState& state, btCollisionObject& object) {
    object.setWorldTransform(state.pose);
    if (btRigidBody* body = btRigidBody::upcast(&object)) {
        body->setLinearVelocity(state.velocity);
        body->setAngularVelocity(state.spin);
        body->setCenterOfMassTransform(state.pose);  // inertia in the world's frame too
        body->clearForces();
        body->applyCentralForce(state.force);
        body->applyTorque(state.torque);
    }
    object.setInterpolationWorldTransform(state.interpolation);
    object.setInterpolationLinearVelocity(state.interpolationVelocity);
    object.setInterpolationAngularVelocity(state.interpolationSpin);
    object.forceActivationState(state.activation);
    object.setDeactivationTime(state.deactivationTime);
}

void save(const BodyState& state, ByteWriter& out) {
    out.put(state.shapeType);
    out.put(state.flags);
    out.put(static_cast<std::uint8_t>(state.isRigidBody));
    put(out, state.pose);
    put(out, state.interpolation);
    put(out, state.interpolationVelocity);
    put(out, state.interpolationSpin);
    out.put(state.activation);
    out.put(state.deactivationTime);
    for (const btVector3& v : {state.velocity, state.spin, state.force, state.torque}) {
        put(out, v);
    }
}

BodyState loadBodyState(ByteReader& in) {
    BodyState state;
    state.shapeType = in.get<int>();
    state.flags = in.get<int>();
    state.isRigidBody = in.flag();
    state.pose = getTransform(in);
    state.interpolation = getTransform(in);
    state.interpolationVelocity = getVector(in);
    state.interpolationSpin = getVector(in);
    state.activation = in.get<int>();
    state.deactivationTime = in.get<btScalar>();
    for (btVector3* v : {&state.velocity, &state.spin, &state.force, &state.torque}) {
        *v = getVector(in);
    }
    return state;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
