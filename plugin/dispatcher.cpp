#include <grapeshot/plugin/dispatcher.hpp>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btQuickprof.h>

#include <utility>
#include <vector>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/frame_work.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

bool isOurs(const btCollisionObject& first, const btCollisionObject& second, const Context& context) {
    return kindOf(*first.getCollisionShape(), *second.getCollisionShape(), context.settings) != PairKind::foreign;
}

/// The pair's algorithm, if it is ours. A new pair gets one, as Bullet's near callback would do; that of the program
/// may not want it.
PairProcessor* processorOf(btBroadphasePair& pair, btCollisionObject& first, btCollisionObject& second,
                           btCollisionDispatcher& dispatcher) {
    if (pair.m_algorithm == nullptr) {
        if (dispatcher.getNearCallback() != &btCollisionDispatcher::defaultNearCallback) {
            return nullptr;
        }
        const btCollisionObjectWrapper wrap0(nullptr, first.getCollisionShape(), &first, first.getWorldTransform(), -1,
                                             -1);
        const btCollisionObjectWrapper wrap1(nullptr, second.getCollisionShape(), &second, second.getWorldTransform(),
                                             -1, -1);
        pair.m_algorithm = dispatcher.findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    }
    const auto* ours = dynamic_cast<MeshCollisionAlgorithm*>(pair.m_algorithm);
    return ours != nullptr ? ours->processor() : nullptr;
}

void collect(btCollisionDispatcher& dispatcher, btOverlappingPairCache& cache, const btDispatcherInfo& info,
             const Context& context, std::vector<PairProcessor*>& pairs) {
    btBroadphasePairArray& all = cache.getOverlappingPairArray();
    for (int i = 0; i < all.size(); ++i) {
        btBroadphasePair& pair = all[i];
        auto* first = static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
        auto* second = static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
        if (!isOurs(*first, *second, context) || !dispatcher.needsCollision(first, second)) {
            continue;
        }
        PairProcessor* processor = processorOf(pair, *first, *second, dispatcher);
        if (processor != nullptr && processor->isOf(context) && processor->prepare(*first, *second, info)) {
            pairs.push_back(processor);
        }
    }
}

}  // namespace

DispatchPhases::DispatchPhases(btCollisionDispatcher& dispatcher, btOverlappingPairCache* cache,
                               const btDispatcherInfo& info) noexcept {
    try {
        m_context = Contexts::instance().find(&dispatcher);
        if (!m_context || cache == nullptr) {
            return;
        }
        m_context->framed = true;
        ++m_context->dispatches;
        if (m_context->frame.enterDispatch(cache, m_context->settings.frameBudget)) {
            m_context->beginStep();
        }
        m_nested = std::exchange(m_context->dispatching, true);
        m_context->building.clear();
        if (info.m_dispatchFunc == btDispatcherInfo::DISPATCH_DISCRETE) {
            std::vector<PairProcessor*> pairs;
            {
                BT_PROFILE("grapeshot.collect");
                collect(dispatcher, *cache, info, *m_context, pairs);
            }
            {
                BT_PROFILE("grapeshot.compute");
                computeFrame(pairs, std::exchange(m_context->building, {}), m_context->frame, m_context->settings);
            }
        }
        if (m_context->frame.isInMain()) {
            m_context->softLoop.run(*m_context, info.m_timeStep);
        }
        m_context->reportFrame();
    } catch (...) {
        // Out of memory: Bullet's pass computes what was not.
    }
}

DispatchPhases::~DispatchPhases() {
    if (m_context) {
        m_context->dispatching = m_nested;
        m_context->reportFrame();
    }
}

void beginFrame(const btCollisionDispatcher& dispatcher, int dispatches) noexcept {
    const std::shared_ptr<Context> context = Contexts::instance().find(&dispatcher);
    if (context) {
        context->framed = true;
        context->frame.begin(dispatches, context->settings.frameBudget);
        context->beginStep();
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
