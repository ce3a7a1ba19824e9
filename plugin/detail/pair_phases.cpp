// The phases of a pair before Bullet's pass.
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <bit>
#include <type_traits>

#include <grapeshot/narrowphase/schedule.hpp>
#include <grapeshot/plugin/detail/pair_ahead.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>
#include <grapeshot/plugin/detail/proxy_id.hpp>
#include <grapeshot/plugin/detail/swept_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Bit by bit: a NaN is the same as itself.
bool sameNumber(btScalar x, btScalar y) {
    using Bits = std::conditional_t<sizeof(btScalar) == 8, std::uint64_t, std::uint32_t>;
    return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
}

/// Work units that a pair may want while a sample stands in for one of its meshes: the rest had better go into the
/// tree.
constexpr std::uint64_t standInSlice = 96;

bool samePose(const btTransform& x, const btTransform& y) {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (!sameNumber(x.getBasis()[i][j], y.getBasis()[i][j])) {
                return false;
            }
        }
        if (!sameNumber(x.getOrigin()[i], y.getOrigin()[i])) {
            return false;
        }
    }
    return true;
}

float inverseMass(const btCollisionObject& object) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body != nullptr ? static_cast<float>(body->getInvMass()) : 0.0F;
}

}  // namespace

bool PairProcessor::prepare(btCollisionObject& body0, btCollisionObject& body1, const btDispatcherInfo& info) {
    if (m_ahead == nullptr) {
        m_ahead = std::make_unique<Ahead>();
    }
    Ahead& ahead = *m_ahead;
    m_unwanted = m_unwanted || ahead.ready;
    ahead.ready = false;
    if (m_unwanted || m_shared != nullptr || m_query) {
        return false;
    }
    const std::array<btCollisionObject*, 2> objects{&body0, &body1};
    if (m_shapes[0] != nullptr && isChanged(*body0.getCollisionShape(), *body1.getCollisionShape())) {
        return false;
    }
    for (std::size_t i = 0; i < 2; ++i) {
        ahead.poses[i] = objects[i]->getWorldTransform();
        ahead.bodies[i].emplace(nullptr, objects[i]->getCollisionShape(), objects[i], ahead.poses[i], -1, -1);
    }
    const Bodies bodies{&*ahead.bodies[0], &*ahead.bodies[1]};
    m_step = m_context->enterStep(m_step);
    look(bodies);
    std::string refusal;
    if (m_kind == PairKind::foreign || !findModels(bodies, m_rebound, ahead.shapes, refusal)) {
        return false;  // Bullet's pass will say why
    }
    ahead.task = task(ahead.shapes, info.m_timeStep, 0);
    ahead.ready = true;
    ahead.attempted = ahead.failed = false;
    m_share = {};
    return true;
}

void PairProcessor::compute(const Budget& budget) noexcept {
    Ahead& ahead = *m_ahead;
    ahead.task.budget = budget;
    ahead.task.again = ahead.attempted;
    PairResult& sum = m_share.result;
    if (!ahead.attempted) {
        m_share.mandatory = std::min(mandatory(), budget.work);
    }
    try {
        addResult(m_contacts.step(ahead.shapes, ahead.task));
    } catch (...) {
        ahead.failed = true;  // the contacts of the last step stay
        sum.stop = StopReason::budget;
        sum.certain = false;
    }
    m_share.slice = budget.work > unlimited - m_share.slice ? unlimited : m_share.slice + budget.work;
    ahead.attempted = true;
}

bool PairProcessor::takeAhead(const Bodies& bodies, PairShapes& shapes) {
    if (m_ahead == nullptr || !m_ahead->ready) {
        return false;
    }
    Ahead& ahead = *m_ahead;
    ahead.ready = false;
    for (std::size_t i = 0; i < 2; ++i) {
        const btCollisionObjectWrapper& known = *ahead.bodies[i];
        // A callback of the program's may have moved it or changed its shape meanwhile.
        if (bodies[i]->m_parent != nullptr || bodies[i]->getCollisionObject() != known.getCollisionObject() ||
            bodies[i]->getCollisionShape() != m_shapes[i] || m_shapes[i]->getShapeType() != m_types[i] ||
            !samePose(bodies[i]->getWorldTransform(), known.getWorldTransform())) {
            return false;
        }
    }
    if (!ahead.attempted || ahead.failed) {
        return false;
    }
    shapes = ahead.shapes;
    shapes.a = ahead.shapes.a == &*ahead.bodies[0] ? bodies[0] : bodies[1];
    shapes.b = shapes.a == bodies[0] ? bodies[1] : bodies[0];
    return true;
}

bool PairProcessor::needsBullet() const {
    return m_ahead->shapes.modelB == nullptr && asksBullet(*m_ahead->shapes.b->getCollisionShape());
}

bool PairProcessor::wasCutShort() const {
    return m_share.result.stop == StopReason::budget && !m_ahead->failed && !standsIn();
}

std::uint64_t PairProcessor::key() const {
    return keyOf(*m_ahead->bodies[0]->getCollisionObject(), *m_ahead->bodies[1]->getCollisionObject());
}

std::uint64_t PairProcessor::mandatory() const {
    return mandatoryOf(m_ahead->shapes, m_ahead->task);
}

std::uint64_t PairProcessor::wanted() const {
    if (standsIn()) {
        return standInSlice;
    }
    return m_cutShort ? unlimited : m_lastNeed + m_lastNeed / 4;
}

std::uint64_t PairProcessor::mandatoryOf(const PairShapes& shapes, const PairTask& task) const {
    const bool features = m_context->settings.method == Method::scf && shapes.modelB;
    if (m_contacts.touches() && !m_cutShort) {
        return mandatorySlice;
    }
    const std::uint64_t search = features ? featureSlice : searchSlice;
    if (m_contacts.touches()) {
        return search;
    }
    return search + (sweptMotion(shapes, task) > 0 ? sweepSlice : 0);
}

PairTraits PairProcessor::traits() const {
    const Ahead& ahead = *m_ahead;
    PairTraits traits;
    const btScalar radiusB = ahead.shapes.modelB ? btScalar(ahead.shapes.modelB->mesh->tree.radius) : btScalar(0);
    const btScalar motion = approachBound(*ahead.shapes.a, btScalar(ahead.shapes.modelA->mesh->tree.radius),
                                          *ahead.shapes.b, radiusB, ahead.task.timeStep);
    traits.motion = static_cast<float>(motion) / std::max(ahead.task.breaking, 1e-9F);
    const btCollisionObject& first = *ahead.bodies[0]->getCollisionObject();
    const btCollisionObject& second = *ahead.bodies[1]->getCollisionObject();
    const float inverse = inverseMass(first) + inverseMass(second);
    traits.mass = inverse > 0 ? 1 / inverse : 0;
    traits.size = m_size.size;
    traits.staleness = m_staleness;
    traits.uncertain = m_cutShort;
    traits.weight = m_context->settings.pairWeight != nullptr ? m_context->settings.pairWeight(first, second) : 1.0F;
    return traits;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
