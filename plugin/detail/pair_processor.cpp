#include <grapeshot/plugin/detail/pair_processor.hpp>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

int proxyOf(const btCollisionObjectWrapper& wrap) {
    const btBroadphaseProxy* proxy = wrap.getCollisionObject()->getBroadphaseHandle();
    return proxy != nullptr ? proxy->getUid() : -1;
}

}  // namespace

PairProcessor::PairProcessor(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context,
                             bool query)
    : m_dispatcher(*info.m_dispatcher1),
      m_context(std::move(context)),
      m_query(query),
      m_writer(*info.m_dispatcher1, info.m_manifold),
      m_shared(info.m_manifold) {}

PairProcessor::~PairProcessor() {
    dropDelegate();
}

void PairProcessor::process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                            const btDispatcherInfo& info, btManifoldResult& result) {
    const Bodies bodies{&body0, &body1};
    if (!m_query) {
        m_step = m_context->enterStep(m_step);
    }
    const bool rebound = bind(bodies);
    if (m_settingsVersion != m_context->settingsVersion) {
        m_settingsVersion = m_context->settingsVersion;
        m_contacts.forgetCandidates();
    }
    if (m_kind == PairKind::foreign) {
        m_writer.clear();
        delegate(bodies, info, result);
        return;
    }
    dropDelegate();
    PairStatistics pair;
    pair.proxyA = proxyOf(body0);
    pair.proxyB = proxyOf(body1);
    PairShapes shapes;
    std::string refusal;
    if (!findModels(bodies, rebound, shapes, refusal)) {
        m_contacts.forget();
        m_writer.clear();
        report(pair, &refusal);
        return;
    }
    if (m_query) {
        m_contacts.forget();  // without memory
    }
    solve(bodies, shapes, info, result, pair);
    if (pair.stop == StopReason::invalidInput) {
        refusal = "the bodies' relative pose is not rigid, or a margin is no number";
        report(pair, &refusal);
    } else {
        report(pair, nullptr);
    }
}

bool PairProcessor::bind(const Bodies& bodies) {
    bool changed = false;
    for (std::size_t i = 0; i < 2; ++i) {
        const btCollisionShape* shape = bodies[i]->getCollisionShape();
        // Another shape may have taken the address.
        changed = changed || m_shapes[i] != shape || m_types[i] != shape->getShapeType();
        m_shapes[i] = shape;
        m_types[i] = shape->getShapeType();
    }
    const PairKind kind = kindOf(*m_shapes[0], *m_shapes[1], m_context->settings.convexPairs);
    changed = changed || kind != m_kind;
    if (changed) {
        dropDelegate();
        m_kind = kind;
        m_contacts.forget();
        m_writer.clear();
        m_breaking = breakingThreshold(bodies);
        for (std::size_t i = 0; i < 2; ++i) {
            m_models[i].reset();
            m_entries[i].reset();
            if (m_kind != PairKind::foreign && isMesh(*m_shapes[i])) {
                m_entries[i] = ShapeModels::instance().entry(*m_shapes[i]);
            }
        }
    }
    return changed;
}

/// As Bullet gives it to new manifolds.
btScalar PairProcessor::breakingThreshold(const Bodies& bodies) const {
    const auto* dispatcher = dynamic_cast<const btCollisionDispatcher*>(&m_dispatcher);
    btScalar threshold = gContactBreakingThreshold;
    if (dispatcher == nullptr ||
        (dispatcher->getDispatcherFlags() & btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD) != 0) {
        threshold = btMin(bodies[0]->getCollisionObject()->getCollisionShape()->getContactBreakingThreshold(threshold),
                          bodies[1]->getCollisionObject()->getCollisionShape()->getContactBreakingThreshold(threshold));
    }
    return threshold;
}

void PairProcessor::delegate(const Bodies& bodies, const btDispatcherInfo& info, btManifoldResult& result) {
    if (m_delegate == nullptr) {
        m_delegate = m_dispatcher.findAlgorithm(bodies[0], bodies[1], m_shared,
                                                m_query ? BT_CLOSEST_POINT_ALGORITHMS : BT_CONTACT_POINT_ALGORITHMS);
    }
    if (m_delegate != nullptr) {
        m_delegate->processCollision(bodies[0], bodies[1], info, &result);
    }
}

void PairProcessor::dropDelegate() {
    if (m_delegate != nullptr) {
        m_delegate->~btCollisionAlgorithm();
        m_dispatcher.freeCollisionAlgorithm(m_delegate);
        m_delegate = nullptr;
    }
}

bool PairProcessor::findModels(const Bodies& bodies, bool rebound, PairShapes& shapes, std::string& refusal) {
    // Steps of different dispatchers have the same numbers; queries always look.
    const std::uint64_t step = m_query ? 0 : (m_context->serial << 40U) + m_step;
    bool resized = rebound;
    for (std::size_t i = 0; i < 2; ++i) {
        if (!m_entries[i]) {
            continue;
        }
        std::shared_ptr<const ShapeModel> model = m_entries[i]->model(*m_shapes[i], ShapeModels::instance().cache(),
                                                                      rebound ? Check::thorough : Check::sampled, step);
        if (!model->mesh) {
            refusal = model->error;
            m_models[i].reset();
            return false;
        }
        if (model != m_models[i]) {
            if (m_models[i] && m_models[i]->topology == model->topology) {
                m_contacts.forgetCandidates();
            } else {
                m_contacts.forget();
            }
            m_models[i] = std::move(model);
            resized = true;
        }
    }
    const std::size_t a = m_kind == PairKind::solidMesh ? 1 : 0;
    shapes.a = bodies[a];
    shapes.b = bodies[1 - a];
    shapes.modelA = m_models[a];
    shapes.modelB = m_models[1 - a];
    shapes.marginA = marginOf(*m_shapes[a]);
    shapes.marginB = shapes.modelB ? marginOf(*m_shapes[1 - a]) : marginBeyond(*m_shapes[1 - a]);
    if (resized) {
        m_size = sizeOf(shapes);
    }
    return true;
}

PairTask PairProcessor::task(const PairShapes& shapes, const btDispatcherInfo& info,
                             const btManifoldResult& result) const {
    PairTask task;
    task.settings = &m_context->settings;
    task.budget = m_query ? m_context->settings.queryBudget : m_context->settings.pairBudget;
    task.size = m_size;
    const btScalar margins = shapes.marginA + shapes.marginB;
    task.breaking = static_cast<float>(m_breaking);
    task.maxDistance = static_cast<float>(margins + m_breaking);
    task.closestDistance = static_cast<float>(margins + result.m_closestPointDistanceThreshold);
    // Outside stepSimulation it is 0.
    task.timeStep = m_query || !(info.m_timeStep > 0) ? btScalar(0) : info.m_timeStep;
    return task;
}

void PairProcessor::solve(const Bodies& bodies, const PairShapes& shapes, const btDispatcherInfo& info,
                          btManifoldResult& result, PairStatistics& pair) {
    const PairTask what = task(shapes, info, result);
    const PairResult found = m_contacts.step(shapes, what);
    ContactBodies contactBodies{shapes.a, shapes.b, shapes.modelA->parts, {}, shapes.marginA, shapes.marginB};
    if (shapes.modelB) {
        contactBodies.partsB = shapes.modelB->parts;
    }
    contactBodies.aIsFirst = shapes.a == bodies[0];
    const Written written = m_writer.write(m_contacts.now(), m_contacts.ahead(), contactBodies,
                                           2 * pairSettings(what).set.mergeDistance, result);
    pair.work = found.work;
    pair.candidates = found.candidates;
    pair.traversed = found.traversed;
    pair.refreshed = found.refreshed;
    pair.certain = found.certain;
    pair.stop = found.stop;
    pair.droppedRegions = m_contacts.now().droppedRegions;
    pair.contacts = written.contacts;
    pair.speculative = written.ahead;
    pair.manifolds = written.manifolds;
    pair.deepest = written.deepest;
}

void PairProcessor::report(const PairStatistics& pair, const std::string* refusal) {
    StepStatistics& statistics = m_context->statistics;
    if (!m_query) {
        refusal != nullptr ? m_context->refuse(pair, *refusal) : m_context->record(pair);
        return;
    }
    ++statistics.queries;
    statistics.queryWork += pair.work;
    if (refusal != nullptr) {
        ++statistics.refusals;
        statistics.lastRefusal = *refusal;
    }
}

void PairProcessor::collectManifolds(btManifoldArray& manifolds) const {
    m_writer.collect(manifolds);
    if (m_delegate != nullptr) {
        m_delegate->getAllContactManifolds(manifolds);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
