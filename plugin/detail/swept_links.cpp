#include <grapeshot/plugin/swept_world.hpp>

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

void sweepLinkAabbs(btCollisionWorld& world) noexcept {
    const btScalar seconds = world.getDispatchInfo().m_timeStep;
    if (!world.getDispatchInfo().m_useContinuous || !(seconds > 0)) {
        return;
    }
    const btVector3 around(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
    for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
        btCollisionObject& object = *world.getCollisionObjectArray()[i];
        btBroadphaseProxy* proxy = object.getBroadphaseHandle();
        if (btMultiBodyLinkCollider::upcast(&object) == nullptr || object.isStaticOrKinematicObject() ||
            !object.isActive() || proxy == nullptr) {
            continue;
        }
        btVector3 lower;
        btVector3 upper;
        object.getCollisionShape()->getAabb(predicted(object, motionOf(object), seconds), lower, upper);
        lower -= around;
        upper += around;
        lower.setMin(proxy->m_aabbMin);
        upper.setMax(proxy->m_aabbMax);
        // Beyond that Bullet takes a body for one that has blown up.
        if (isFinite(lower) && isFinite(upper) && (upper - lower).length2() < btScalar(1e12)) {
            world.getBroadphase()->setAabb(proxy, lower, upper, world.getDispatcher());
        }
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
