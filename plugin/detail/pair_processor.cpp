#include <grapeshot/plugin/detail/pair_processor.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <utility>

#include <grapeshot/narrowphase/schedule.hpp>
#include <grapeshot/plugin/detail/pair_ahead.hpp>
#include <grapeshot/plugin/detail/proxy_id.hpp>
#include <grapeshot/plugin/detail/swept_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Will Bullet call the program's material callback?
bool tellsProgram(const std::array<const btCollisionObjectWrapper*, 2>& bodies) {
    return gContactAddedCallback != nullptr && std::ranges::any_of(bodies, [](const btCollisionObjectWrapper* body) {
               return (body->getCollisionObject()->getCollisionFlags() &
                       btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
           });
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
    m_processing = true;
    try {
        processNow({&body0, &body1}, info, result);
    } catch (...) {
        m_processing = false;
        if (m_closed) {
            close();
        }
        throw;
    }
    m_processing = false;
    if (m_closed) {
        close();
    }
}

void PairProcessor::close() {
    m_closed = true;
    if (m_processing) {
        m_writer.stop();
        return;
    }
    m_writer.clear();
    dropDelegate();
}

void PairProcessor::look(const Bodies& bodies) {
    m_rebound = bind(bodies);
    if (m_settingsVersion != m_context->settingsVersion) {
        m_settingsVersion = m_context->settingsVersion;
        m_contacts.forgetCandidates();
    }
}

void PairProcessor::processNow(const Bodies& bodies, const btDispatcherInfo& info, btManifoldResult& result) {
    if (!m_query) {
        m_step = m_context->enterStep(m_step);
    }
    m_unwanted = false;
    PairShapes shapes;
    if (takeAhead(bodies, shapes)) {
        write(bodies, shapes, result);
        return;
    }
    look(bodies);
    m_share = {};
    if (m_kind == PairKind::foreign) {
        m_writer.clear();
        delegate(bodies, info, result);
        return;
    }
    dropDelegate();
    std::string refusal;
    if (!findModels(bodies, m_rebound, shapes, refusal)) {
        m_contacts.forget();
        m_writer.clear();
        report(bodies, {}, &refusal);
        return;
    }
    if (m_query) {
        m_contacts.forget();  // without memory
    }
    goOnBuilding();
    computeNow(shapes, task(shapes, info.m_timeStep, result.m_closestPointDistanceThreshold));
    write(bodies, shapes, result);
}

bool PairProcessor::isChanged(const btCollisionShape& shape0, const btCollisionShape& shape1) const {
    // Another shape may have taken the address.
    return m_shapes[0] != &shape0 || m_shapes[1] != &shape1 || m_types[0] != shape0.getShapeType() ||
           m_types[1] != shape1.getShapeType() || m_kind != kindOf(shape0, shape1, m_context->settings);
}

bool PairProcessor::bind(const Bodies& bodies) {
    const bool changed = isChanged(*bodies[0]->getCollisionShape(), *bodies[1]->getCollisionShape());
    if (changed) {
        dropDelegate();
        for (std::size_t i = 0; i < 2; ++i) {
            m_shapes[i] = bodies[i]->getCollisionShape();
            m_types[i] = m_shapes[i]->getShapeType();
        }
        m_kind = kindOf(*m_shapes[0], *m_shapes[1], m_context->settings);
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
    const std::uint64_t look = m_context->framed ? m_context->dispatches : m_step;  // a frame may have several substeps
    const std::uint64_t step = m_query ? 0 : (m_context->serial << 40U) + look;
    Frame* frame = m_query ? nullptr : m_context->openFrame();
    const Pace pace = frame != nullptr ? Pace::inSlices : m_context->beside ? Pace::beside : Pace::atOnce;
    bool resized = rebound;
    for (std::size_t i = 0; i < 2; ++i) {
        if (!m_entries[i]) {
            continue;
        }
        std::uint64_t work = 0;
        std::shared_ptr<const ShapeModel> model = m_entries[i]->model(
            *m_shapes[i], ShapeModels::instance().cache(), rebound ? Check::thorough : Check::sampled, step, pace, work,
            m_context->settings.method == Method::scf);
        if (frame != nullptr) {
            frame->payBuilding(work, work);
            if (m_entries[i]->isBuilding() &&
                std::ranges::find(m_context->building, m_entries[i]) == m_context->building.end()) {
                m_context->building.push_back(m_entries[i]);
            }
        }
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

/// Of shapes that only turned up in Bullet's pass.
void PairProcessor::goOnBuilding() {
    Frame* frame = m_query ? nullptr : m_context->openFrame();
    if (frame == nullptr) {
        return;
    }
    for (const std::shared_ptr<ShapeEntry>& entry : std::exchange(m_context->building, {})) {
        Budget slice = frame->latecomerSlice(buildingSlice);
        slice.work = std::max(buildingSlice, slice.work / 2);  // the pair wants some too
        const std::uint64_t work = entry->goOnBuilding(slice);
        frame->payBuilding(work, std::min(work, buildingSlice));
    }
}

PairTask PairProcessor::task(const PairShapes& shapes, btScalar timeStep, btScalar closestDistance) const {
    PairTask task;
    task.settings = &m_context->settings;
    task.pair = keyOf(*shapes.a->getCollisionObject(), *shapes.b->getCollisionObject());
    task.budget = m_query ? m_context->settings.queryBudget : m_context->settings.pairBudget;
    task.size = m_size;
    const btScalar margins = shapes.marginA + shapes.marginB;
    task.breaking = static_cast<float>(m_breaking);
    task.maxDistance = static_cast<float>(margins + m_breaking);
    task.closestDistance = static_cast<float>(margins + closestDistance);
    // Outside stepSimulation it is 0.
    task.timeStep = m_query || !(timeStep > 0) ? btScalar(0) : timeStep;
    return task;
}

/// A pair that Bullet's pass brings up: a query, a child of a compound, or any where there is no frame.
void PairProcessor::computeNow(const PairShapes& shapes, const PairTask& task) {
    Frame* frame = m_query ? nullptr : m_context->openFrame();
    PairTask now = task;
    m_share.mandatory = mandatoryOf(shapes, task);
    Budget slice;
    if (frame != nullptr) {
        slice = frame->latecomerSlice(m_share.mandatory);
        // With a time, first the mandatory part, whatever that takes.
        now.budget.work = std::min(now.budget.work, slice.time != never ? m_share.mandatory : slice.work);
    }
    m_share.slice = now.budget.work;
    m_share.result = m_contacts.step(shapes, now);
    if (slice.time != never && m_share.result.stop == StopReason::budget) {
        now.budget = slice;
        now.budget.work = std::min(slice.work, task.budget.work);
        now.budget.work -= std::min(now.budget.work, m_share.result.work);
        now.budget.time = std::min(slice.time, task.budget.time);
        now.again = true;
        m_share.slice += now.budget.work;
        addResult(m_contacts.step(shapes, now));
    }
    settle();
    if (frame != nullptr) {
        m_share.mandatory = std::min(m_share.mandatory, m_share.slice);
        frame->payLatecomer(m_share.result.work, m_share.mandatory);
    }
}

/// Of a further call in the same step.
void PairProcessor::addResult(PairResult more) {
    PairResult& sum = m_share.result;
    more.work += sum.work;
    more.candidates += sum.candidates;
    more.traversed = more.traversed || sum.traversed;
    more.collides = more.collides || sum.collides;
    more.sampled = more.sampled || (sum.sampled && !more.certain);
    sum = more;
}

void PairProcessor::settle() {
    const PairResult& result = m_share.result;
    m_cutShort = result.stop == StopReason::budget;
    if (m_cutShort) {
        ++m_staleness;
        m_age = m_share.slice > m_share.mandatory ? 0 : m_age + 1;
    } else {
        m_age = m_staleness = 0;
        m_lastNeed = result.work;
    }
}

void PairProcessor::write(const Bodies& bodies, const PairShapes& shapes, btManifoldResult& result) {
    if (m_share.result.stop == StopReason::invalidInput) {
        m_writer.clear();
        static const std::string reason = "the bodies' relative pose is not rigid, or a margin is no number";
        report(bodies, {}, &reason);
        return;
    }
    // Of a sample the parts are empty: its triangles have no names.
    ContactBodies contactBodies{shapes.a, shapes.b, shapes.modelA->parts, {}, shapes.marginA, shapes.marginB};
    if (shapes.modelB) {
        contactBodies.partsB = shapes.modelB->parts;
    }
    if (m_query || tellsProgram(bodies)) {
        contactBodies.treeA = &shapes.modelA->mesh->tree;
        contactBodies.treeB = shapes.modelB ? &shapes.modelB->mesh->tree : nullptr;
    }
    contactBodies.aIsFirst = shapes.a == bodies[0];
    const float reach = 2 * m_context->settings.mergeDistance * m_size.size;
    report(bodies, m_writer.write(m_contacts.now(), m_contacts.ahead(), contactBodies, reach, result), nullptr);
}

bool PairProcessor::standsIn() const {
    return std::ranges::any_of(m_models, [](const auto& model) { return model && model->isStandIn; });
}

void PairProcessor::report(const Bodies& bodies, const Written& written, const std::string* refusal) {
    const PairResult& found = m_share.result;
    PairStatistics pair;
    pair.proxyA = proxyOf(*bodies[0]->getCollisionObject());
    pair.proxyB = proxyOf(*bodies[1]->getCollisionObject());
    pair.work = found.work;
    pair.slice = m_share.slice;
    pair.age = m_age;
    pair.candidates = found.candidates;
    pair.traversed = found.traversed;
    pair.refreshed = found.refreshed;
    pair.certain = found.certain && !standsIn();
    pair.method = found.method;
    pair.sampled = found.sampled;
    pair.missBound = found.missBound;
    pair.leftToAdb = m_context->settings.method == Method::scf && m_kind == PairKind::meshMesh && refusal == nullptr &&
                     found.method != Method::scf;
    pair.stop = found.stop == StopReason::certain && standsIn() ? StopReason::budget : found.stop;
    pair.droppedRegions = refusal != nullptr ? 0 : m_contacts.now().droppedRegions;
    pair.contacts = written.contacts;
    pair.speculative = written.ahead;
    pair.manifolds = written.manifolds;
    pair.deepest = written.deepest;
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
