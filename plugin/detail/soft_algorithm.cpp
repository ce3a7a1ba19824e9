#include <grapeshot/plugin/detail/soft_algorithm.hpp>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btEmptyCollisionAlgorithm.h>
#include <LinearMath/btQuickprof.h>

#include <new>

#include <grapeshot/plugin/detail/compound_algorithm.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/soft_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

SoftAlgorithm::SoftAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context)
    : btCollisionAlgorithm(info), m_pair(std::make_shared<SoftPair>(*info.m_dispatcher1, std::move(context))) {}

SoftAlgorithm::~SoftAlgorithm() = default;

void SoftAlgorithm::processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                                     const btDispatcherInfo& info, btManifoldResult* result) noexcept {
    BT_PROFILE("grapeshot.softPair");
    const std::shared_ptr<SoftPair> pair = m_pair;
    try {
        pair->process(*body0, *body1, info, *result);
    } catch (...) {
        // Out of memory: no contacts in this step; the next one tries again.
    }
}

void SoftAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) noexcept {
    m_pair->collectManifolds(manifolds);
}

btCollisionAlgorithm* SoftAlgorithm::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0,
    const btCollisionObjectWrapper* body1) noexcept {
    const btCollisionShape& first = *body0->getCollisionShape();
    const btCollisionShape& second = *body1->getCollisionShape();
    const bool children = isGImpactCompound(first) || isGImpactCompound(second);
    const std::size_t size = children ? sizeof(CompoundAlgorithm) : sizeof(SoftAlgorithm);
    void* place = info.m_dispatcher1->allocateCollisionAlgorithm(static_cast<int>(size));
    try {
        btCollisionAlgorithm* made = nullptr;
        if (children) {
            made = new (place) CompoundAlgorithm(info, m_context.shared_from_this(), false);
        } else {
            made = new (place) SoftAlgorithm(info, m_context.shared_from_this());
        }
        m_context.countAlgorithm(first.getShapeType(), second.getShapeType());
        return made;
    } catch (...) {
        return new (place) btEmptyAlgorithm(info);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
