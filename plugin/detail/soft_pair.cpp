#include <grapeshot/plugin/detail/soft_pair.hpp>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <algorithm>

#include <grapeshot/plugin/detail/proxy_id.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

btSoftBody* softOf(const btCollisionObjectWrapper& wrap) {
    // Of a compound's child the object is the whole body.
    return const_cast<btSoftBody*>(btSoftBody::upcast(wrap.getCollisionObject()));
}

bool isDisabled(const btSoftBody& soft, const btCollisionObject& other) {
    const auto& disabled = soft.m_collisionDisabledObjects;
    return disabled.findLinearSearch(&other) != disabled.size();
}

}  // namespace

Budget softBudget(Context& context) {
    Budget budget = context.settings.pairBudget;
    if (const Frame* frame = context.openFrame()) {
        const Budget slice = frame->latecomerSlice(softSlice);
        // A tracker takes up to 40 units more than it may have.
        budget.work = std::min(budget.work, slice.work == unlimited ? unlimited : slice.work - 40);
        if (slice.time != never) {
            budget.time = std::min(budget.time, slice.time);
            budget.clock = slice.clock;
        }
    }
    return budget;
}

void reportSoftPair(Context& context, const btCollisionObject& first, const btCollisionObject& second,
                    const SoftPairResult& result, const Budget& budget) {
    PairStatistics pair;
    pair.proxyA = proxyOf(first);
    pair.proxyB = proxyOf(second);
    pair.soft = true;
    pair.method = Method::scf;
    pair.sampled = !result.near.certain && !result.near.isWhole && (budget.work != unlimited || budget.time != never);
    pair.work = result.near.work;
    pair.slice = budget.work;
    pair.candidates = static_cast<std::uint32_t>(result.pairs);
    pair.contacts = result.contacts;
    pair.speculative = result.crossings;
    pair.deepest = result.deepest;
    pair.certain = result.near.certain;
    pair.stop = result.near.stop;
    pair.traversed = true;
    pair.missBound = result.near.certain ? 0 : result.near.miss.missedBound;
    if (Frame* frame = context.openFrame()) {
        frame->payLatecomer(pair.work, result.near.isWhole ? pair.work : std::min(pair.work, softSlice));
    }
    result.refusal.empty() ? context.record(pair) : context.refuse(pair, result.refusal);
}

SoftPair::SoftPair(btDispatcher& dispatcher, std::shared_ptr<Context> context)
    : m_dispatcher(dispatcher), m_context(std::move(context)) {
    m_context->softLoop.enter(*this);
}

SoftPair::~SoftPair() {
    m_context->softLoop.leave(*this);
    dropDelegate();
}

namespace {

/// Both want corners against faces, in the same world.
bool isOurs(const btSoftBody& first, const btSoftBody& second) {
    using Flags = btSoftBody::fCollision;
    const bool velocities = rigidWorldOf(first) == SoftWorld::velocities;
    if (velocities != (rigidWorldOf(second) == SoftWorld::velocities)) {
        return false;
    }
    const int kinds = first.m_cfg.collisions & second.m_cfg.collisions & Flags::SVSmask;
    // With both VF_SS and VF_DD Bullet's own handler, which that world calls later once more, does nothing.
    return kinds == Flags::VF_SS || (velocities && kinds == (Flags::VF_SS | Flags::VF_DD));
}

}  // namespace

void SoftPair::process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                       const btDispatcherInfo& info, btManifoldResult& result) {
    m_step = m_context->enterStep(m_step);
    btSoftBody* soft0 = softOf(body0);
    btSoftBody* soft1 = softOf(body1);
    const bool wanted = m_context->settings.softPairs;
    if (wanted && soft0 != nullptr && soft1 != nullptr && isOurs(*soft0, *soft1)) {
        m_rigid.reset();
        dropDelegate();
        processSoft(*soft0, *soft1, info.m_timeStep);
        return;
    }
    m_soft.reset();
    btSoftBody* soft = soft0 != nullptr ? soft0 : soft1;
    const btCollisionObjectWrapper& other = soft0 != nullptr ? body1 : body0;
    if (wanted && (soft0 == nullptr) != (soft1 == nullptr) && isMesh(*other.getCollisionShape()) &&
        rigidWorldOf(*soft) != SoftWorld::neither) {
        dropDelegate();
        processMesh(*soft, other, info);
        return;
    }
    m_rigid.reset();
    delegate(body0, body1, info, result);
}

void SoftPair::processSoft(btSoftBody& first, btSoftBody& second, btScalar timeStep) {
    if (isDisabled(first, second) || isDisabled(second, first)) {
        m_soft.reset();
        return;
    }
    if (m_soft == nullptr) {
        m_soft = std::make_unique<SoftSoftPair>(*m_context);
    }
    SoftSoftTask task;
    task.budget = softBudget(*m_context);
    task.look = m_context->framed ? m_context->dispatches : m_step;
    task.key = keyOf(first, second);
    task.world = rigidWorldOf(first);
    task.timeStep = timeStep;
    task.distance =
        static_cast<float>(first.getCollisionShape()->getMargin() + second.getCollisionShape()->getMargin());
    reportSoftPair(*m_context, first, second, m_soft->process(first, second, task), task.budget);
}

void SoftPair::processMesh(btSoftBody& soft, const btCollisionObjectWrapper& rigid, const btDispatcherInfo& info) {
    const btCollisionObject& object = *rigid.getCollisionObject();
    if (isDisabled(soft, object)) {
        m_rigid.reset();
        return;
    }
    if (m_rigid == nullptr) {
        m_rigid = std::make_unique<SoftRigidPair>(*m_context);
    }
    const Budget budget = softBudget(*m_context);
    const std::uint64_t look = m_context->framed ? m_context->dispatches : m_step;
    reportSoftPair(*m_context, soft, object,
                   m_rigid->process(soft, rigid, info.m_timeStep, look, keyOf(soft, object), budget), budget);
}

void SoftPair::appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const {
    if (m_soft != nullptr) {
        m_soft->appendContacts(body, contacts);
    }
    if (m_rigid != nullptr) {
        m_rigid->appendContacts(body, contacts);
    }
}

void SoftPair::delegate(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                        const btDispatcherInfo& info, btManifoldResult& result) {
    if (m_delegate == nullptr) {
        btCollisionAlgorithmConstructionInfo construction;
        construction.m_dispatcher1 = &m_dispatcher;
        construction.m_manifold = nullptr;
        m_delegate = m_context->createPrevious(construction, body0, body1);
    }
    if (m_delegate != nullptr) {
        m_delegate->processCollision(&body0, &body1, info, &result);
    }
}

void SoftPair::dropDelegate() {
    if (m_delegate != nullptr) {
        m_delegate->~btCollisionAlgorithm();
        m_dispatcher.freeCollisionAlgorithm(m_delegate);
        m_delegate = nullptr;
    }
}

void SoftPair::collectManifolds(btManifoldArray& manifolds) const {
    if (m_delegate != nullptr) {
        m_delegate->getAllContactManifolds(manifolds);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
