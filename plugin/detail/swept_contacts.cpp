#include <grapeshot/plugin/detail/swept_contacts.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/penetration.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int mostSteps = 64;
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
    Sweep(const PairShapes& shapes, const PairTask& task, const PairSettings& settings, const ContactSet& touching)
        : m_shapes(shapes),
          m_task(task),
          m_settings(settings),
          m_touching(touching),
          m_motionA(motionOf(*shapes.a->getCollisionObject())),
          m_motionB(motionOf(*shapes.b->getCollisionObject())),
          m_now(toPose(relative(shapes.a->getWorldTransform(), shapes.b->getWorldTransform()))) {}

    /// `motion` (m) is what the bodies may approach by in the first `seconds` of the step.
    std::uint64_t run(float motion, btScalar seconds, ContactSet& ahead) {
        const float stride = std::max(0.5F * m_task.size.thickness, m_settings.maxDistance);
        const int steps = std::clamp(static_cast<int>(std::ceil(motion / stride)), 1, mostSteps);
        btScalar before = 0;
        for (int k = 1; k <= steps; ++k) {
            btScalar after = seconds * btScalar(k) / btScalar(steps);
            if (!touches(after)) {
                before = after;
                continue;
            }
            std::vector<SurfaceContact> first = m_found;
            for (int i = 0; i < bisections; ++i) {
                const btScalar middle = (before + after) / 2;
                if (touches(middle)) {
                    after = middle;
                    first = m_found;
                } else {
                    before = middle;
                }
            }
            ContactSetSettings set = m_settings.set;
            set.maxDistance = motion + m_settings.maxDistance;
            merge(ahead, first, m_now, true, set);
            break;
        }
        return m_work;
    }

  private:
    /// Are there contacts at that time which are none now? Left in m_found, as they are now.
    bool touches(btScalar seconds) {
        const Pose then =
            toPose(relative(predicted(*m_shapes.a, m_motionA, seconds), predicted(*m_shapes.b, m_motionB, seconds)));
        m_then.clear();
        m_found.clear();
        if (!isRigid(then)) {
            return false;
        }
        m_work += nearContacts(m_shapes, then, m_settings.maxDistance, m_settings, m_task.budget, m_then);
        const Pose thenToNow = compose(m_now, inverse(then));  // of points fixed to B, A's frame
        for (SurfaceContact contact : m_then) {
            contact.onB = apply(thenToNow, contact.onB);
            contact.normal = thenToNow.rotation * contact.normal;
            contact.signedDistance = contact.normal.dot(contact.onA - contact.onB);
            if (contact.signedDistance > m_settings.maxDistance && !touchesThere(contact.normal)) {
                m_found.push_back(contact);
            }
        }
        return !m_found.empty();
    }

    [[nodiscard]] bool touchesThere(const Eigen::Vector3f& normal) const {
        constexpr float sameSide = 0.7F;
        return std::any_of(m_touching.slots.begin(), m_touching.slots.end(), [&](const RegionSlot& slot) {
            return slot.count > 0 && (m_now.rotation * slot.normalInB).dot(normal) > sameSide;
        });
    }

    const PairShapes& m_shapes;
    const PairTask& m_task;
    const PairSettings& m_settings;
    const ContactSet& m_touching;
    Motion m_motionA, m_motionB;
    Pose m_now;
    std::vector<SurfaceContact> m_then, m_found;
    std::uint64_t m_work = 0;
};

}  // namespace

std::uint64_t nearContacts(const PairShapes& shapes, const Pose& bInA, float reach, const PairSettings& settings,
                           Budget budget, std::vector<SurfaceContact>& found) {
    LocalContactSettings local = settings.local;
    local.maxDistance = reach;
    if (!shapes.modelB) {
        return solidContacts(*shapes.modelA->mesh, {shapes.b->getCollisionShape(), toTransform(bInA)}, reach, local,
                             found);
    }
    const MeshModel& a = *shapes.modelA->mesh;
    const MeshModel& b = *shapes.modelB->mesh;
    Contacts contacts;
    Query(a.tree, b.tree).contacts(bInA, {reach, Order::bestFirst}, budget, contacts);
    localContacts(a, b, bInA, contacts.pairs, local, found);
    const bool overlapping = std::any_of(contacts.pairs.begin(), contacts.pairs.end(),
                                         [](const TriangleContact& pair) { return pair.overlapping; });
    if (overlapping) {
        const float spacing = settings.set.regions.spacing;
        const std::vector<SurfaceContact> already = found;
        penetrationContacts(a, b, bInA, contacts.pairs, already, {spacing, spacing, maxPointsPerRegion}, found);
    }
    return contacts.work;
}

std::uint64_t sweptContacts(const PairShapes& shapes, const PairTask& task, const PairSettings& settings,
                            const ContactSet& now, ContactSet& ahead) {
    const btScalar radiusB = shapes.modelB ? btScalar(shapes.modelB->mesh->tree.radius)
                                           : 2 * btScalar(sizeOf(*shapes.b->getCollisionShape()).halfDiagonal);
    const btScalar bound =
        approachBound(*shapes.a, btScalar(shapes.modelA->mesh->tree.radius), *shapes.b, radiusB, task.timeStep);
    const float motion = std::min(static_cast<float>(bound), task.settings->speculativeLimit);
    if (!(motion > std::max(0.5F * task.size.thickness, settings.maxDistance)) || !std::isfinite(motion)) {
        return 0;
    }
    const btScalar seconds = task.timeStep * btMin(btScalar(1), btScalar(motion) / bound);
    return Sweep(shapes, task, settings, now).run(motion, seconds, ahead);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
