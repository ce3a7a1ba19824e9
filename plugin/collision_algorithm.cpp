#include <grapeshot/plugin/collision_algorithm.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btEmptyCollisionAlgorithm.h>
#include <LinearMath/btQuickprof.h>

#include <new>

#include <grapeshot/plugin/detail/compound_algorithm.hpp>
#include <grapeshot/plugin/detail/pair_processor.hpp>
#include <grapeshot/plugin/registration.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

using detail::Context;
using detail::PairProcessor;

static_assert(sizeof(AdbCollisionAlgorithm) == sizeof(MeshCollisionAlgorithm) &&
              sizeof(ScfCollisionAlgorithm) == sizeof(MeshCollisionAlgorithm));

MeshCollisionAlgorithm::MeshCollisionAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                                               std::shared_ptr<Context> context, bool query) noexcept
    : btActivatingCollisionAlgorithm(info) {
    try {
        m_pair = std::make_shared<PairProcessor>(info, std::move(context), query);
    } catch (...) {
        m_pair.reset();
    }
}

MeshCollisionAlgorithm::~MeshCollisionAlgorithm() {
    if (m_pair != nullptr) {
        m_pair->close();
    }
}

void MeshCollisionAlgorithm::processCollision(const btCollisionObjectWrapper* body0,
                                              const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
                                              btManifoldResult* result) noexcept {
    BT_PROFILE("grapeshot.pair");
    // A callback of the program's may remove a body, and with it this algorithm.
    const std::shared_ptr<PairProcessor> pair = m_pair;
    if (pair == nullptr) {
        return;
    }
    try {
        pair->process(*body0, *body1, info, *result);
    } catch (...) {
        // Out of memory: the contacts of the last step stay, the next step tries again.
    }
}

btScalar MeshCollisionAlgorithm::calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                                       btManifoldResult*) noexcept {
    return 1;
}

void MeshCollisionAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) noexcept {
    if (m_pair != nullptr) {
        m_pair->collectManifolds(manifolds);
    }
}

namespace {

/// Null: there is no GImpact compound in it, or the settings leave it alone.
btCollisionAlgorithm* createForChildren(btCollisionAlgorithmConstructionInfo& info,
                                        const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                                        Context& context, bool query) noexcept {
    using detail::CompoundAlgorithm;
    const auto isCompound = [](const btCollisionObjectWrapper& body) {
        return detail::isGImpactCompound(*body.getCollisionShape());
    };
    if (!context.settings.convexPairs || !(isCompound(body0) || isCompound(body1))) {
        return nullptr;
    }
    void* place = info.m_dispatcher1->allocateCollisionAlgorithm(static_cast<int>(sizeof(CompoundAlgorithm)));
    try {
        auto* made = new (place) CompoundAlgorithm(info, context.shared_from_this(), query);
        context.countAlgorithm(body0.getCollisionShape()->getShapeType(), body1.getCollisionShape()->getShapeType());
        return made;
    } catch (...) {
        info.m_dispatcher1->freeCollisionAlgorithm(place);
        return nullptr;
    }
}

}  // namespace

MeshCollisionAlgorithm::CreateFunc::CreateFunc(const Settings& settings, bool query)
    : m_own(std::make_shared<Context>(settings)), m_context(m_own.get()), m_query(query) {}

MeshCollisionAlgorithm::CreateFunc::CreateFunc(Context& context, bool query) noexcept
    : m_context(&context), m_query(query) {}

btCollisionAlgorithm* MeshCollisionAlgorithm::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0,
    const btCollisionObjectWrapper* body1) noexcept {
    const detail::PairKind kind =
        detail::kindOf(*body0->getCollisionShape(), *body1->getCollisionShape(), m_context->settings);
    if (kind == detail::PairKind::foreign) {
        if (btCollisionAlgorithm* children = createForChildren(info, *body0, *body1, *m_context, m_query)) {
            return children;
        }
        btCollisionAlgorithm* foreign =
            m_context->createForeign(info, body0, body1, m_query ? detail::Table::closest : detail::Table::contacts);
        if (foreign != nullptr) {
            return foreign;
        }
        void* place = info.m_dispatcher1->allocateCollisionAlgorithm(static_cast<int>(sizeof(btEmptyAlgorithm)));
        return new (place) btEmptyAlgorithm(info);
    }
    m_context->countAlgorithm(body0->getCollisionShape()->getShapeType(), body1->getCollisionShape()->getShapeType());
    void* place = info.m_dispatcher1->allocateCollisionAlgorithm(static_cast<int>(sizeof(MeshCollisionAlgorithm)));
    if (m_context->settings.method == Method::scf) {
        return new (place) ScfCollisionAlgorithm(info, m_context->shared_from_this(), m_query);
    }
    return new (place) AdbCollisionAlgorithm(info, m_context->shared_from_this(), m_query);
}

namespace {

Settings by(Method method, Settings settings = {}) {
    settings.method = method;
    return settings;
}

}  // namespace

AdbCollisionAlgorithm::CreateFunc::CreateFunc(const Settings& settings, bool query)
    : MeshCollisionAlgorithm::CreateFunc(settings.method == Method::scf ? by(Method::adb, settings) : settings, query) {
}

Status AdbCollisionAlgorithm::registerAlgorithm(btCollisionDispatcher* dispatcher) noexcept {
    return registerAlgorithms(dispatcher, by(Method::adb));
}

ScfCollisionAlgorithm::CreateFunc::CreateFunc(const Settings& settings, bool query)
    : MeshCollisionAlgorithm::CreateFunc(by(Method::scf, settings), query) {}

Status ScfCollisionAlgorithm::registerAlgorithm(btCollisionDispatcher* dispatcher) noexcept {
    return registerAlgorithms(dispatcher, by(Method::scf));
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
