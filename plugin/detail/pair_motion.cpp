#include <grapeshot/plugin/detail/pair_motion.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

Motion motionOf(const btCollisionObject& object) {
    if (object.isStaticObject()) {
        return {};
    }
    if (const btRigidBody* body = btRigidBody::upcast(&object)) {
        return {body->getLinearVelocity(), body->getAngularVelocity()};
    }
    return {object.getInterpolationLinearVelocity(), object.getInterpolationAngularVelocity()};
}

btTransform predicted(const btCollisionObjectWrapper& wrap, const Motion& motion, btScalar seconds) {
    const btTransform& body = wrap.getCollisionObject()->getWorldTransform();
    btTransform moved;
    btTransformUtil::integrateTransform(body, motion.velocity, motion.spin, seconds, moved);
    return moved * body.inverseTimes(wrap.getWorldTransform());
}

namespace {

btScalar turnBound(const btCollisionObjectWrapper& wrap, const Motion& motion, btScalar radius) {
    const btScalar spin = motion.spin.length();
    if (!(spin > 0)) {
        return 0;  // also for planes, whose radius is infinite
    }
    const btVector3& centre = wrap.getCollisionObject()->getWorldTransform().getOrigin();
    return spin * ((wrap.getWorldTransform().getOrigin() - centre).length() + radius);
}

}  // namespace

btScalar approachBound(const btCollisionObjectWrapper& a, btScalar radiusA, const btCollisionObjectWrapper& b,
                       btScalar radiusB, btScalar seconds) {
    const Motion motionA = motionOf(*a.getCollisionObject());
    const Motion motionB = motionOf(*b.getCollisionObject());
    return seconds * ((motionA.velocity - motionB.velocity).length() + turnBound(a, motionA, radiusA) +
                      turnBound(b, motionB, radiusB));
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
