#include <grapeshot/plugin/detail/pair_motion.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <LinearMath/btTransformUtil.h>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Of a link's centre of mass, in its own frame: from the base outwards along the links that carry it, each joint
/// adding its own (Featherstone. Rigid Body Dynamics Algorithms. 2008, section 5.3).
Motion linkMotion(const btMultiBody& body, int link) {
    if (link < 0) {
        const btQuaternion& toBase = body.getWorldToBaseRot();
        return {quatRotate(toBase, body.getBaseVel()), quatRotate(toBase, body.getBaseOmega())};
    }
    const Motion parent = linkMotion(body, body.getParent(link));
    const btQuaternion& toLink = body.getParentToLocalRot(link);
    Motion motion;
    motion.spin = quatRotate(toLink, parent.spin);
    motion.velocity = quatRotate(toLink, parent.velocity) + motion.spin.cross(body.getRVector(link));
    const btScalar* rates = body.getJointVelMultiDof(link);
    for (int i = 0; i < body.getLink(link).m_dofCount; ++i) {
        motion.spin += rates[i] * body.getLink(link).getAxisTop(i);
        motion.velocity += rates[i] * body.getLink(link).getAxisBottom(i);
    }
    return motion;
}

}  // namespace

Motion motionOf(const btCollisionObject& object) {
    if (object.isStaticObject()) {
        return {};
    }
    const btMultiBodyLinkCollider* link = btMultiBodyLinkCollider::upcast(&object);
    if (link != nullptr && link->m_multiBody != nullptr && link->m_link < link->m_multiBody->getNumLinks()) {
        const Motion inLink = linkMotion(*link->m_multiBody, link->m_link);
        const btMatrix3x3& toWorld = object.getWorldTransform().getBasis();
        return {toWorld * inLink.velocity, toWorld * inLink.spin};
    }
    if (const btRigidBody* body = btRigidBody::upcast(&object)) {
        return {body->getLinearVelocity(), body->getAngularVelocity()};
    }
    return {object.getInterpolationLinearVelocity(), object.getInterpolationAngularVelocity()};
}

btTransform predicted(const btCollisionObject& object, const Motion& motion, btScalar seconds) {
    btTransform moved;
    btTransformUtil::integrateTransform(object.getWorldTransform(), motion.velocity, motion.spin, seconds, moved);
    return moved;
}

btTransform predicted(const btCollisionObjectWrapper& wrap, const Motion& motion, btScalar seconds) {
    const btTransform& body = wrap.getCollisionObject()->getWorldTransform();
    return predicted(*wrap.getCollisionObject(), motion, seconds) * body.inverseTimes(wrap.getWorldTransform());
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
