#include <grapeshot/plugin/detail/share_of_way.hpp>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

btScalar shareOfWay(const RigidWay& way, const SurfaceInStep& rigid, std::span<const SoftSurfaceContact> contacts) {
    const float allowed = 0.5F * way.distance;
    btScalar share = 1;
    for (const SoftSurfaceContact& contact : contacts) {
        Eigen::Vector3f point = Eigen::Vector3f::Zero();
        for (int i = 0; i < 3; ++i) {
            point += contact.weightsB[i] * rigid.after[contact.b[static_cast<std::size_t>(i)]];
        }
        const btVector3 local = toBullet(point);
        const btVector3 moved = way.to * local - way.from * local;
        const btScalar approach = moved.dot(way.to.getBasis() * toBullet(contact.normal));
        const auto tooFar = btScalar(std::min(contact.before, way.distance) - allowed - contact.after);
        if (approach > btScalar(allowed) && tooFar > 0) {
            share = btMin(share, btMax(btScalar(0), 1 - tooFar / approach));
        }
    }
    return share;
}

void slowDown(const btCollisionObject& object, btScalar share) {
    auto* body = const_cast<btRigidBody*>(btRigidBody::upcast(&object));
    if (body != nullptr && !body->isStaticOrKinematicObject() && body->isActive() && share < 1) {
        body->setLinearVelocity(share * body->getLinearVelocity());
        body->setAngularVelocity(share * body->getAngularVelocity());
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
