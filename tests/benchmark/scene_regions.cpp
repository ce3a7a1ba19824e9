#include "scene_regions.hpp"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include <algorithm>
#include <optional>

#include <Eigen/Geometry>

#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/pair_processor.hpp>
#include <grapeshot/plugin/detail/saved_pair.hpp>

namespace grapeshot::bench {

namespace {

/// A contact in A's frame.
struct PlacedContact {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
    float distance = 0;
};

void append(const RegionSlot& slot, const Pose& bInA, std::vector<PlacedContact>& contacts) {
    for (int i = 0; i < slot.count; ++i) {
        const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
        contacts.push_back({point.localA, bInA.rotation * point.normalInB, point.signedDistance});
    }
}

/// Those of a set that belong to a region of which some contacts are known.
std::vector<PlacedContact> belonging(const ContactSet& set, const std::vector<PlacedContact>& region, const Pose& bInA,
                                     const RegionSettings& settings) {
    std::vector<PlacedContact> contacts;
    for (const RegionSlot& slot : set.slots) {
        append(slot, bInA, contacts);
    }
    std::erase_if(contacts, [&](const PlacedContact& contact) {
        return std::ranges::none_of(region, [&](const PlacedContact& one) {
            return (one.position - contact.position).norm() <= settings.spacing &&
                   one.normal.dot(contact.normal) >= settings.normalCone;
        });
    });
    return contacts;
}

struct Push {
    Eigen::Vector3f force = Eigen::Vector3f::Zero();
    Eigen::Vector3f torque = Eigen::Vector3f::Zero();
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
};

Push pushOf(const std::vector<PlacedContact>& contacts, float reach) {
    Push push;
    float sum = 0;
    for (const PlacedContact& contact : contacts) {
        const float strength = std::max(0.0F, reach - contact.distance);
        push.force += strength * contact.normal;
        push.torque += strength * contact.position.cross(contact.normal);
        push.middle += strength * contact.position;
        sum += strength;
    }
    push.middle /= std::max(sum, 1e-12F);
    return push;
}

/// As Bullet gives it to new manifolds.
btScalar breakingThreshold(const btCollisionShape& a, const btCollisionShape& b) {
    return btMin(a.getContactBreakingThreshold(gContactBreakingThreshold),
                 b.getContactBreakingThreshold(gContactBreakingThreshold));
}

/// What the pair's last search looked for, up to `distance` (m), by adb.
PairSettings exactSettings(const btCollisionShape& a, const btCollisionShape& b, const Settings& settings,
                           float distance) {
    detail::PairShapes shapes;
    shapes.modelA = detail::ShapeModels::instance().present(a);
    shapes.modelB = detail::ShapeModels::instance().present(b);
    detail::PairTask task;
    task.settings = &settings;
    task.size = detail::sizeOf(shapes);
    task.breaking = static_cast<float>(breakingThreshold(a, b));
    task.maxDistance = static_cast<float>(detail::marginOf(a) + detail::marginOf(b)) + task.breaking;
    PairSettings exact = detail::pairSettings(task, detail::anyApproach);
    exact.maxDistance = exact.local.maxDistance = distance;
    exact.method = Method::adb;
    return exact;
}

/// Calls use(the two bodies' indices, overlapping pair, its processor, what is saved of it) for every pair of meshes.
template <class Use>
void forMeshPairs(scenes::World& world, const Use& use) {
    const btBroadphasePairArray& pairs = world.dynamics().getPairCache()->getOverlappingPairArray();
    for (int i = 0; i < pairs.size(); ++i) {
        const auto* algorithm = dynamic_cast<const MeshCollisionAlgorithm*>(pairs[i].m_algorithm);
        const detail::PairProcessor* pair = algorithm != nullptr ? algorithm->processor() : nullptr;
        if (pair == nullptr || !pair->remembers()) {
            continue;
        }
        const detail::SavedPair saved = pair->saved();
        if (saved.kind == detail::PairKind::meshMesh) {
            const auto* a = static_cast<const btCollisionObject*>(pairs[i].m_pProxy0->m_clientObject);
            const auto* b = static_cast<const btCollisionObject*>(pairs[i].m_pProxy1->m_clientObject);
            use(*a, *b, *pair, saved);
        }
    }
}

std::pair<int, int> keyOf(const btCollisionObject& a, const btCollisionObject& b) {
    return {a.getWorldArrayIndex(), b.getWorldArrayIndex()};
}

}  // namespace

void RegionWatch::before(scenes::World& world) {
    m_poses.clear();
    const btCollisionObjectArray& objects = world.dynamics().getCollisionObjectArray();
    for (int i = 0; i < objects.size(); ++i) {
        m_poses.push_back(objects[i]->getWorldTransform());
    }
    m_before.clear();
    forMeshPairs(world, [&](const btCollisionObject& a, const btCollisionObject& b, const detail::PairProcessor&,
                            const detail::SavedPair& saved) { m_before[keyOf(a, b)] = saved.state; });
}

void RegionWatch::after(scenes::World& world) {
    std::map<std::pair<int, int>, Truth> still;
    forMeshPairs(world, [&](const btCollisionObject& a, const btCollisionObject& b, const detail::PairProcessor& pair,
                            const detail::SavedPair& saved) {
        if (pair.share().result.stop == StopReason::invalidInput) {
            return;
        }
        const std::pair key = keyOf(a, b);
        Truth& truth = still[key];
        if (const auto known = m_truths.find(key); known != m_truths.end()) {
            truth = std::move(known->second);
        }
        const Step step{
            *pair.model(0), *pair.model(1),
            detail::toPose(detail::relative(m_poses[static_cast<std::size_t>(key.first)],
                                            m_poses[static_cast<std::size_t>(key.second)])),
            exactSettings(*a.getCollisionShape(), *b.getCollisionShape(), m_settings, saved.state.searchDistance),
            m_before[key]};
        update(step.a, step.b, step.bInA, step.exact, {}, truth.state);
        compare(saved.state.contacts, step, truth);
    });
    m_truths = std::move(still);
}

void RegionWatch::compare(const ContactSet& found, const Step& step, Truth& truth) {
    const RegionSettings& settings = step.exact.set.regions;
    std::optional<PairState> own;
    std::map<std::uint32_t, Life> still;
    for (const RegionSlot& slot : truth.state.contacts.slots) {
        if (slot.id == 0 || slot.count == 0) {
            continue;
        }
        Life& life = still[slot.id];
        life = truth.lives[slot.id];
        ++life.age;
        std::vector<PlacedContact> region;
        append(slot, step.bInA, region);
        const auto ours = belonging(found, region, step.bInA, settings);
        if (life.found == 0 && !ours.empty()) {
            life.found = life.age;
            if (!own) {
                own = step.before;
                update(step.a, step.b, step.bInA, step.exact, {}, *own);
            }
            const Push truly = pushOf(belonging(own->contacts, region, step.bInA, settings), step.exact.maxDistance);
            const Push push = pushOf(ours, step.exact.maxDistance);
            const float force = std::max(truly.force.norm(), 1e-12F);
            m_counts.forceErrors.push_back((push.force - truly.force).norm() / force);
            m_counts.torqueErrors.push_back((push.torque - truly.torque).norm() /
                                            (force * std::max(truly.middle.norm(), 1e-6F)));
        }
        if (life.age == 2 || life.found > 0) {
            count(life);
        }
    }
    for (const auto& [id, life] : truth.lives) {
        m_counts.brief += !still.contains(id) && !life.counted ? 1 : 0;
    }
    truth.lives = std::move(still);
}

void RegionWatch::count(Life& life) {
    if (!life.counted) {
        life.counted = true;
        ++m_counts.regions;
        m_counts.atFirst += life.found == 1 ? 1 : 0;
        m_counts.withinTwo += life.found > 0 ? 1 : 0;
    }
}

}  // namespace grapeshot::bench
