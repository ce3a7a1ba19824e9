#include <grapeshot/plugin/detail/swept_contacts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <grapeshot/core/purse.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>
#include <grapeshot/plugin/detail/stop_points.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int mostSteps = 1024;  // most of them far apart, which costs a comparison
constexpr int bisections = 4;

btTransform toTransform(const Pose& pose) {
    btTransform transform;
    for (int row = 0; row < 3; ++row) {
        transform.getBasis()[row] = toBullet(Eigen::Vector3f(pose.rotation.row(row)));
    }
    transform.setOrigin(toBullet(pose.translation));
    return transform;
}

class Sweep {
  public:
    Sweep(const PairShapes& shapes, const PairTask& task, const PairSettings& settings, const Budget& budget,
          const ContactSet& touching)
        : m_shapes(shapes),
          m_task(task),
          m_purse(budget),
          m_settings(settings),
          m_touching(touching),
          m_motionA(motionOf(*shapes.a->getCollisionObject())),
          m_motionB(motionOf(*shapes.b->getCollisionObject())),
          m_now(toPose(relative(shapes.a->getWorldTransform(), shapes.b->getWorldTransform()))) {
        findBall();
    }

    /// `motion` (m) is what the bodies may approach by in the first `seconds` of the step.
    Swept run(float motion, btScalar seconds, ContactSet& ahead) {
        stopWhereTheyTouch(seconds);
        const bool complete = lookAhead(motion, seconds, ahead);
        for (RegionSlot& slot : m_stops) {
            slot.id = ahead.nextId++;
            ahead.slots.push_back(slot);
        }
        return {m_purse.spent(), complete};
    }

  private:
    /// False if the budget ended it.
    bool lookAhead(float motion, btScalar seconds, ContactSet& ahead) {
        // In strides of half their thickness bodies overlap at some moment on the way, unless they do already. Where
        // that is too many, they are looked at as often as their contact distance says.
        const float fine = 0.5F * m_task.size.thickness;
        // A sheet has no inside: flat in a wall it cuts nothing.
        const bool solids = m_shapes.modelB && m_shapes.modelA->mesh->solid && m_shapes.modelB->mesh->solid;
        if (solids && motion <= static_cast<float>(mostSteps) * fine) {
            m_query.emplace(m_shapes.modelA->mesh->tree, m_shapes.modelB->mesh->tree);
            if (hits(0)) {
                m_query.reset();
            }
        }
        const float stride = m_query ? fine : std::max(fine, m_settings.maxDistance);
        const int steps = std::clamp(static_cast<int>(std::ceil(motion / stride)), 1, mostSteps);
        btScalar before = 0;
        btScalar after = 0;
        for (int k = 1; k <= steps && after <= 0; ++k) {
            const btScalar here = seconds * btScalar(k) / btScalar(steps);
            (hits(here) ? after : before) = here;
            if (m_purse.isEmpty()) {
                return false;
            }
        }
        if (after <= 0) {
            return true;
        }
        for (int i = 0; i < bisections && !m_purse.isEmpty(); ++i) {
            const btScalar middle = (before + after) / 2;
            (hits(middle) ? after : before) = middle;
        }
        // The last moment before: what is nearest then touches first, and no overlap hides which way is out. With what
        // follows within a stride, so that the body does not turn about a single point into the other.
        collect(before, m_settings.maxDistance + motion / static_cast<float>(steps));
        if (m_found.empty()) {
            collect(after, m_settings.maxDistance);
        }
        if (!m_found.empty()) {
            ContactSetSettings set = m_settings.set;
            set.maxDistance = motion + m_settings.maxDistance;
            merge(ahead, m_found, m_now, true, set);
            stop();
        }
        return !m_purse.isEmpty();
    }

    [[nodiscard]] Pose poseAt(btScalar seconds) const {
        return toPose(relative(predicted(*m_shapes.a, m_motionA, seconds), predicted(*m_shapes.b, m_motionB, seconds)));
    }

    /// The ball around the smaller body does not reach the larger mesh's box. A plane is never far.
    [[nodiscard]] bool isFar(const Pose& then) const {
        const Eigen::Vector3f middle = apply(m_smallIsA ? inverse(then) : then, m_middle);
        const float reach = m_radius + m_settings.maxDistance;
        const Eigen::Vector3f beyond = (m_large->lower - middle).cwiseMax(middle - m_large->upper).cwiseMax(0.0F);
        return beyond.squaredNorm() > reach * reach;
    }

    void findBall() {
        const Tree& a = m_shapes.modelA->mesh->tree;
        m_large = &a;
        if (!m_shapes.modelB) {
            const btCollisionShape& solid = *m_shapes.b->getCollisionShape();
            m_radius = std::numeric_limits<float>::infinity();
            if (solid.getShapeType() != STATIC_PLANE_PROXYTYPE) {
                btVector3 center;
                btScalar radius = 0;
                solid.getBoundingSphere(center, radius);
                m_middle = toEigen(center);
                m_radius = static_cast<float>(radius);
            }
            return;
        }
        const Tree& b = m_shapes.modelB->mesh->tree;
        m_smallIsA = a.radius <= b.radius;
        m_large = m_smallIsA ? &b : &a;
        m_radius = std::min(a.radius, b.radius);
    }

    /// Do the bodies overlap at that time? If that cannot be asked: are there contacts which are none now?
    bool hits(btScalar seconds) {
        const Pose then = poseAt(seconds);
        if (!isRigid(then) || isFar(then)) {
            m_found.clear();
            return false;
        }
        if (!m_query) {
            collect(seconds, m_settings.maxDistance);
            return !m_found.empty();
        }
        const Decision decision = m_query->decide(then, DecideSettings::exact(), m_purse.left());
        m_purse.pay(decision.work);
        return decision.certain && decision.collides;
    }

    /// Held at a few points alone, it would turn about them and go through.
    void stopWhereTheyTouch(btScalar seconds) {
        const btVector3 velocity = m_motionA.velocity - m_motionB.velocity;
        const btMatrix3x3& turn = m_shapes.a->getWorldTransform().getBasis();
        for (const RegionSlot& slot : m_touching.slots) {
            if (slot.count == 0) {
                continue;
            }
            const PersistentPoint& point = slot.points[0];
            FirstTouch touch{{}, m_now, m_now, {}};
            touch.contact.onA = point.localA;
            touch.contact.onB = apply(m_now, point.localB);
            touch.contact.normal = touch.normalNow = m_now.rotation * point.normalInB;
            touch.contact.triangleA = point.triangleA;
            touch.contact.triangleB = point.triangleB;
            const auto approach = -static_cast<float>(velocity.dot(turn * toBullet(touch.contact.normal)) * seconds);
            if (approach > std::max(0.5F * m_task.size.thickness, m_settings.maxDistance)) {
                addStop(touch);
            }
        }
    }

    void addStop(const FirstTouch& touch) {
        if (m_purse.left().work < stopWork) {
            return;
        }
        RegionSlot slot;
        stopPoints(m_shapes, m_task.size, touch, slot);
        m_purse.pay(stopWork);
        if (slot.count > 0) {
            m_stops.push_back(slot);
        }
    }

    /// Whatever touches first, the rest of the body is not to go through there. After `collect` has found something.
    void stop() {
        FirstTouch touch{{}, m_thenPose, m_now, {}};
        float least = std::numeric_limits<float>::infinity();
        for (const SurfaceContact& contact : m_then) {
            const Eigen::Vector3f normalNow = m_turnToNow * contact.normal;
            if (contact.signedDistance < least && !touchesThere(normalNow)) {
                least = contact.signedDistance;
                touch.contact = contact;
                touch.normalNow = normalNow;
            }
        }
        if (least < std::numeric_limits<float>::infinity()) {
            addStop(touch);
        }
    }

    /// The contacts of that time within `reach` which are none now, in m_found, as they are now.
    void collect(btScalar seconds, float reach) {
        const Pose then = m_thenPose = poseAt(seconds);
        // A direction in the world, seen from A.
        const btMatrix3x3 turn = m_shapes.a->getWorldTransform().getBasis().transpose() *
                                 predicted(*m_shapes.a, m_motionA, seconds).getBasis();
        m_turnToNow = toPose(btTransform(turn)).rotation;
        m_then.clear();
        m_found.clear();
        if (!isRigid(then)) {
            return;
        }
        m_purse.pay(nearContacts(m_shapes, then, reach, m_settings, m_purse.left(), m_then));
        const Pose thenToNow = compose(m_now, inverse(then));  // of points fixed to B, A's frame
        for (SurfaceContact contact : m_then) {
            contact.onB = apply(thenToNow, contact.onB);
            contact.normal = m_turnToNow * contact.normal;
            contact.signedDistance = contact.normal.dot(contact.onA - contact.onB);
            if (m_motionA.velocity.length2() >= m_motionB.velocity.length2()) {
                // They come together aslant too. The faster one's point counts, or its lever would be wrong.
                contact.onB = contact.onA - contact.signedDistance * contact.normal;
            }
            if (contact.signedDistance > static_cast<float>(m_shapes.marginA + m_shapes.marginB) &&
                !touchesThere(contact.normal)) {
                m_found.push_back(contact);
            }
        }
    }

    [[nodiscard]] bool touchesThere(const Eigen::Vector3f& normal) const {
        constexpr float sameSide = 0.7F;
        return std::any_of(m_touching.slots.begin(), m_touching.slots.end(), [&](const RegionSlot& slot) {
            return slot.count > 0 && (m_now.rotation * slot.normalInB).dot(normal) > sameSide;
        });
    }

    const PairShapes& m_shapes;
    const PairTask& m_task;
    Purse m_purse;
    const PairSettings& m_settings;
    const ContactSet& m_touching;
    Motion m_motionA, m_motionB;
    Pose m_now;
    Pose m_thenPose;  // of m_then
    Eigen::Matrix3f m_turnToNow = Eigen::Matrix3f::Identity();
    const Tree* m_large = nullptr;
    Eigen::Vector3f m_middle = Eigen::Vector3f::Zero();  // of the ball, in the smaller body's frame
    float m_radius = 0;
    bool m_smallIsA = false;
    std::optional<Query> m_query;
    std::vector<SurfaceContact> m_then, m_found;
    std::vector<RegionSlot> m_stops;  // apart: for a merge they would be what has vanished
};

}  // namespace

std::uint64_t nearContacts(const PairShapes& shapes, const Pose& bInA, float reach, const PairSettings& settings,
                           Budget budget, std::vector<SurfaceContact>& found) {
    if (shapes.modelB) {
        PairSettings within = settings;
        within.maxDistance = reach;
        return contactsAt(*shapes.modelA->mesh, *shapes.modelB->mesh, bInA, within, budget, found);
    }
    LocalContactSettings local = settings.local;
    local.maxDistance = reach;
    return solidContacts(*shapes.modelA->mesh, {shapes.b->getCollisionShape(), toTransform(bInA)}, local, budget,
                         found);
}

float stepApproach(const PairShapes& shapes, const PairTask& task) {
    const btScalar radiusB = shapes.modelB ? btScalar(shapes.modelB->mesh->tree.radius)
                                           : 2 * btScalar(sizeOf(*shapes.b->getCollisionShape()).halfDiagonal);
    return static_cast<float>(
        approachBound(*shapes.a, btScalar(shapes.modelA->mesh->tree.radius), *shapes.b, radiusB, task.timeStep));
}

float sweptMotion(const PairShapes& shapes, const PairTask& task) {
    if (!(task.timeStep > 0) || !task.settings->speculative) {
        return 0;
    }
    const float motion = std::min(stepApproach(shapes, task), task.settings->speculativeLimit);
    const bool fast = motion > std::max(0.5F * task.size.thickness, task.maxDistance) && std::isfinite(motion);
    return fast ? motion : 0.0F;
}

Swept sweptContacts(const PairShapes& shapes, const PairTask& task, const PairSettings& settings, const Budget& budget,
                    const ContactSet& now, ContactSet& ahead) {
    const float motion = sweptMotion(shapes, task);
    if (!(motion > 0)) {
        return {};
    }
    const btScalar seconds = task.timeStep * btMin(btScalar(1), btScalar(motion / stepApproach(shapes, task)));
    return Sweep(shapes, task, settings, budget, now).run(motion, seconds, ahead);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
