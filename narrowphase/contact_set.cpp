#include <grapeshot/narrowphase/contact_set.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <grapeshot/narrowphase/detail/point_reduction.hpp>
#include <grapeshot/narrowphase/detail/region_grouping.hpp>

namespace grapeshot {
namespace {

constexpr std::uint32_t none = 0xffffffffU;
constexpr int freeSlot = -1;

// A region that continues no kept point takes an orphaned slot within this many spacings.
constexpr float placeReach = 4.0F;
// Among contacts that continue a kept point equally well (up to this part of mergeDistance) the outermost is taken:
// while a corner slides along a fine mesh, the contacts beside it are as near in one frame or the other.
constexpr float equallyNear = 0.05F;
// A region that has a slot gives it up only to one that is deeper by this part of mergeDistance.
constexpr float slotBonus = 0.5F;

/// A kept point in A's frame now.
struct Kept {
    int slot = 0;
    int place = 0;
    Eigen::Vector3f onA, onB, normal;
    std::uint32_t contact = none;  ///< the step's contact that continues it
    int plan = -1;                 ///< where it goes on; -1: nowhere
};

/// What becomes of one slot, old or new.
struct Plan {
    int slot = freeSlot;          ///< index; freeSlot: a region without one
    std::uint32_t region = none;  ///< of a new slot
    float depth = 0;
    bool hasRegion = false;
};

struct Scratch {
    detail::RegionGroups groups;
    std::vector<std::uint32_t> regionOf;  ///< per contact
    std::vector<char> taken;              ///< per contact: continues a kept point
    std::vector<Kept> kept;
    std::vector<std::pair<std::uint32_t, float>> near;  ///< contact, distance to a kept point
    std::vector<int> votes;                             ///< kept points per (region, slot)
    std::vector<int> planOf;                            ///< per region: index into plans
    std::vector<Plan> plans;
    std::vector<int> order;
    std::vector<Eigen::Vector3f> foreign;
    std::vector<detail::ReductionCandidate> candidates;
    std::vector<std::uint32_t> sources;  ///< beside candidates: index of a kept point, then of contacts
    std::vector<RegionSlot> rebuilt;     ///< beside plans
};

Scratch& threadScratch() {
    thread_local Scratch scratch;
    return scratch;
}

bool isFinite(const PersistentPoint& point) {
    return point.localA.allFinite() && point.localB.allFinite() && point.normalInB.allFinite() &&
           std::isfinite(point.signedDistance);
}

PersistentPoint persistent(const SurfaceContact& contact, const Pose& bInA, std::uint32_t age) {
    PersistentPoint point;
    point.localA = contact.onA;
    point.localB = bInA.rotation.transpose() * (contact.onB - bInA.translation);
    point.normalInB = (bInA.rotation.transpose() * contact.normal).normalized();
    point.signedDistance = contact.signedDistance;
    point.triangleA = contact.triangleA;
    point.triangleB = contact.triangleB;
    point.age = age;
    return point;
}

/// Normal stays; depth and centre follow the points. A slot without points keeps its place, to be found again.
void summarise(RegionSlot& slot, const Pose& bInA) {
    if (slot.count == 0) {
        slot.depth = -std::numeric_limits<float>::max();
        return;
    }
    slot.depth = -std::numeric_limits<float>::max();
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int i = 0; i < slot.count; ++i) {
        const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
        sum += 0.5F * (point.localA + apply(bInA, point.localB));
        slot.depth = std::max(slot.depth, -point.signedDistance);
    }
    slot.centerInA = sum / static_cast<float>(slot.count);
}

const PersistentPoint& keptPoint(const ContactSet& set, const Kept& kept) {
    return set.slots[static_cast<std::size_t>(kept.slot)].points[static_cast<std::size_t>(kept.place)];
}

void gatherKept(const ContactSet& set, const Pose& bInA, Scratch& s) {
    s.kept.clear();
    for (std::size_t i = 0; i < set.slots.size(); ++i) {
        const RegionSlot& slot = set.slots[i];
        for (int p = 0; p < slot.count; ++p) {
            const PersistentPoint& point = slot.points[static_cast<std::size_t>(p)];
            s.kept.push_back({static_cast<int>(i), p, point.localA, apply(bInA, point.localB),
                              bInA.rotation * point.normalInB, none, -1});
        }
    }
}

/// Which of the step's contacts continues which kept point: within mergeDistance on A or on B, and the same direction.
void findCounterparts(const ContactSet& set, std::span<const SurfaceContact> contacts,
                      const ContactSetSettings& settings, Scratch& s) {
    s.taken.assign(contacts.size(), 0);
    const float reach = settings.mergeDistance;
    for (Kept& kept : s.kept) {
        s.near.clear();
        float nearest = std::numeric_limits<float>::max();
        for (std::uint32_t i = 0; i < contacts.size(); ++i) {
            const SurfaceContact& contact = contacts[i];
            const float squared =
                std::min((contact.onA - kept.onA).squaredNorm(), (contact.onB - kept.onB).squaredNorm());
            if (squared <= reach * reach && s.taken[i] == 0 && s.regionOf[i] != none &&
                contact.normal.dot(kept.normal) >= settings.keepCone) {
                const float distance = std::sqrt(squared);
                s.near.emplace_back(i, distance);
                nearest = std::min(nearest, distance);
            }
        }
        const Eigen::Vector3f& center = set.slots[static_cast<std::size_t>(kept.slot)].centerInA;
        float outermost = -1;
        for (const auto& [contact, distance] : s.near) {
            if (distance <= nearest + equallyNear * reach) {
                const float outwards = (contacts[contact].onA - center).squaredNorm();
                if (outwards > outermost) {
                    outermost = outwards;
                    kept.contact = contact;
                }
            }
        }
        if (kept.contact != none) {
            s.taken[kept.contact] = 1;
        }
    }
}

/// Gives the regions to the slots: first by kept points that go on in them (several regions may share a slot, and a
/// slot whose points all went on in another's region is given up: so neither a split nor a join of regions flickers),
/// then by place.
void assignRegions(const ContactSet& set, const Pose& bInA, const ContactSetSettings& settings, Scratch& s) {
    const std::size_t slots = set.slots.size();
    const std::size_t regions = s.groups.regions.size();
    s.votes.assign(regions * slots, 0);
    for (const Kept& kept : s.kept) {
        if (kept.contact != none) {
            ++s.votes[s.regionOf[kept.contact] * slots + static_cast<std::size_t>(kept.slot)];
        }
    }
    s.plans.clear();
    for (std::size_t i = 0; i < slots; ++i) {
        s.plans.push_back({static_cast<int>(i), none, -std::numeric_limits<float>::max(), false});
    }
    s.planOf.assign(regions, -1);
    const auto agrees = [&](std::size_t slot, std::size_t region) {
        return set.slots[slot].id != 0 &&
               (bInA.rotation * set.slots[slot].normalInB).dot(s.groups.regions[region].normal) >= settings.keepCone;
    };
    for (std::size_t r = 0; r < regions; ++r) {
        int most = 0;
        for (std::size_t i = 0; i < slots; ++i) {
            if (s.votes[r * slots + i] > most && agrees(i, r)) {
                most = s.votes[r * slots + i];
                s.planOf[r] = static_cast<int>(i);
            }
        }
        if (s.planOf[r] >= 0) {
            s.plans[static_cast<std::size_t>(s.planOf[r])].hasRegion = true;
        }
    }
    // What is left by place, nearest first. Both counts are small.
    const float reach = placeReach * settings.regions.spacing;
    for (;;) {
        float nearest = reach * reach;
        int bestSlot = -1;
        std::size_t bestRegion = 0;
        for (std::size_t i = 0; i < slots; ++i) {
            if (s.plans[i].hasRegion) {
                continue;
            }
            for (std::size_t r = 0; r < regions; ++r) {
                const float squared = (s.groups.regions[r].center - set.slots[i].centerInA).squaredNorm();
                if (s.planOf[r] < 0 && squared < nearest && agrees(i, r)) {
                    nearest = squared;
                    bestSlot = static_cast<int>(i);
                    bestRegion = r;
                }
            }
        }
        if (bestSlot < 0) {
            break;
        }
        s.planOf[bestRegion] = bestSlot;
        s.plans[static_cast<std::size_t>(bestSlot)].hasRegion = true;
    }
    for (std::uint32_t r = 0; r < regions; ++r) {
        if (s.planOf[r] < 0) {
            s.planOf[r] = static_cast<int>(s.plans.size());
            s.plans.push_back({freeSlot, r, 0, true});
        }
        Plan& plan = s.plans[static_cast<std::size_t>(s.planOf[r])];
        plan.depth = std::max(plan.depth, s.groups.regions[r].depth);
    }
}

/// Where each kept point goes on: in its own slot if that has a region and still faces the same way, else in the slot
/// of the region of its contact. A point that lost its contact while all contacts are known goes nowhere.
void assignKept(const ContactSet& set, std::span<const SurfaceContact> contacts, const Pose& bInA, bool complete,
                const ContactSetSettings& settings, Scratch& s) {
    for (Kept& kept : s.kept) {
        if (kept.contact == none) {
            kept.plan = complete ? -1 : kept.slot;
            continue;
        }
        const Eigen::Vector3f slotNormal = bInA.rotation * set.slots[static_cast<std::size_t>(kept.slot)].normalInB;
        const bool stays = s.plans[static_cast<std::size_t>(kept.slot)].hasRegion &&
                           contacts[kept.contact].normal.dot(slotNormal) >= settings.keepCone;
        kept.plan = stays ? kept.slot : s.planOf[s.regionOf[kept.contact]];
    }
}

/// Fills `candidates` and `sources` with what plan `p` may choose from, kept points first, and its new normal.
void gatherCandidates(int p, const ContactSet& set, std::span<const SurfaceContact> contacts, const Pose& bInA,
                      const ContactSetSettings& settings, RegionSlot& rebuilt, Scratch& s) {
    s.candidates.clear();
    s.sources.clear();
    Eigen::Vector3f normalSum = Eigen::Vector3f::Zero();
    Eigen::Vector3f origin = Eigen::Vector3f::Zero();
    for (std::size_t r = 0; r < s.planOf.size(); ++r) {
        if (s.planOf[r] == p) {
            normalSum += s.groups.regions[r].normal * static_cast<float>(s.groups.membersOf(r).size());
            origin = s.groups.regions[r].center;
        }
    }
    Eigen::Vector3f normal = bInA.rotation * rebuilt.normalInB;
    if (normalSum.norm() > 1e-3F) {
        normal = normalSum.normalized();
        rebuilt.normalInB = (bInA.rotation.transpose() * normal).normalized();
    }
    const Eigen::Vector3f axisU = normal.unitOrthogonal();
    const Eigen::Vector3f axisV = normal.cross(axisU);
    const auto push = [&](const Eigen::Vector3f& onA, const Eigen::Vector3f& onB, float distance, bool kept,
                          std::uint32_t source) {
        const Eigen::Vector3f place = 0.5F * (onA + onB) - origin;
        s.candidates.push_back({onA, place.dot(axisU), place.dot(axisV), distance, kept});
        s.sources.push_back(source);
    };
    for (std::uint32_t k = 0; k < s.kept.size(); ++k) {
        const Kept& kept = s.kept[k];
        if (kept.plan == p) {
            if (kept.contact == none) {
                push(kept.onA, kept.onB, keptPoint(set, kept).signedDistance, true, k);
            } else {
                const SurfaceContact& contact = contacts[kept.contact];
                push(contact.onA, contact.onB, contact.signedDistance, true, k);
            }
        }
    }
    // Points that stay in another slot although their contact is in a region of this one.
    s.foreign.clear();
    for (const Kept& kept : s.kept) {
        if (kept.contact != none && kept.plan != p && s.planOf[s.regionOf[kept.contact]] == p) {
            s.foreign.push_back(contacts[kept.contact].onA);
        }
    }
    const float squaredMerge = settings.mergeDistance * settings.mergeDistance;
    const auto elsewhere = [&](const SurfaceContact& contact) {
        return std::any_of(s.foreign.begin(), s.foreign.end(), [&](const Eigen::Vector3f& point) {
            return (contact.onA - point).squaredNorm() < squaredMerge;
        });
    };
    for (std::size_t r = 0; r < s.planOf.size(); ++r) {
        if (s.planOf[r] != p) {
            continue;
        }
        for (const std::uint32_t member : s.groups.membersOf(r)) {
            if (s.taken[member] == 0 && !elsewhere(contacts[member])) {
                const SurfaceContact& contact = contacts[member];
                push(contact.onA, contact.onB, contact.signedDistance, false, member);
            }
        }
    }
}

void rebuildSlot(int p, const ContactSet& set, std::span<const SurfaceContact> contacts, const Pose& bInA,
                 const ContactSetSettings& settings, RegionSlot& rebuilt, Scratch& s) {
    const Plan& plan = s.plans[static_cast<std::size_t>(p)];
    rebuilt = plan.slot == freeSlot ? RegionSlot{} : set.slots[static_cast<std::size_t>(plan.slot)];
    gatherCandidates(p, set, contacts, bInA, settings, rebuilt, s);
    const detail::Reduction reduction = detail::reducePoints(s.candidates, settings.mergeDistance);
    rebuilt.count = reduction.count;
    rebuilt.points.fill(PersistentPoint{});
    for (int i = 0; i < reduction.count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const auto chosen = static_cast<std::size_t>(reduction.chosen[at]);
        const std::uint32_t source = s.sources[chosen];
        if (!s.candidates[chosen].kept) {
            rebuilt.points[at] = persistent(contacts[source], bInA, 0);
        } else {
            const Kept& kept = s.kept[source];
            const PersistentPoint& old = keptPoint(set, kept);
            rebuilt.points[at] = kept.contact == none ? old : persistent(contacts[kept.contact], bInA, old.age);
        }
    }
    summarise(rebuilt, bInA);
}

/// Regions of plans beyond the cap go to the nearest slot that faces the same way, so that a foot in many pieces keeps
/// its support; those without one are left out, and counted.
void joinOverflow(ContactSet& set, const Pose& bInA, std::size_t cap, const ContactSetSettings& settings, Scratch& s) {
    const auto place = [&](int p) -> std::pair<Eigen::Vector3f, Eigen::Vector3f> {  // centre, normal
        const Plan& plan = s.plans[static_cast<std::size_t>(p)];
        if (plan.slot == freeSlot) {
            return {s.groups.regions[plan.region].center, s.groups.regions[plan.region].normal};
        }
        const RegionSlot& slot = set.slots[static_cast<std::size_t>(plan.slot)];
        return {slot.centerInA, bInA.rotation * slot.normalInB};
    };
    for (std::size_t over = cap; over < s.order.size(); ++over) {
        int nearest = -1;
        float squaredNearest = std::numeric_limits<float>::max();
        const auto [center, normal] = place(s.order[over]);
        for (std::size_t i = 0; i < cap; ++i) {
            const auto [otherCenter, otherNormal] = place(s.order[i]);
            const float squared = (otherCenter - center).squaredNorm();
            if (squared < squaredNearest && otherNormal.dot(normal) >= settings.keepCone) {
                squaredNearest = squared;
                nearest = s.order[i];
            }
        }
        set.droppedRegions += nearest < 0 ? 1U : 0U;
        std::replace(s.planOf.begin(), s.planOf.end(), s.order[over], nearest);
        for (Kept& kept : s.kept) {
            kept.plan = kept.plan == s.order[over] ? nearest : kept.plan;
        }
    }
}

/// Ends plans that have nothing, and the shallowest beyond the cap.
void admit(ContactSet& set, const Pose& bInA, const ContactSetSettings& settings, Scratch& s) {
    for (const Kept& kept : s.kept) {
        if (kept.plan >= 0 && kept.contact == none) {
            Plan& plan = s.plans[static_cast<std::size_t>(kept.plan)];
            plan.depth = std::max(plan.depth, -keptPoint(set, kept).signedDistance);
        }
    }
    const auto rank = [&](int p) {
        const Plan& plan = s.plans[static_cast<std::size_t>(p)];
        return plan.depth + (plan.slot == freeSlot ? 0.0F : slotBonus * settings.mergeDistance);
    };
    s.order.clear();
    for (int p = 0; p < static_cast<int>(s.plans.size()); ++p) {
        if (s.plans[static_cast<std::size_t>(p)].depth > -std::numeric_limits<float>::max()) {
            s.order.push_back(p);
        }
    }
    std::sort(s.order.begin(), s.order.end(),
              [&](int left, int right) { return rank(left) != rank(right) ? rank(left) > rank(right) : left < right; });
    const auto cap = static_cast<std::size_t>(std::clamp(settings.maxRegions, 1, 16));
    set.droppedRegions = 0;
    if (s.order.size() > cap) {
        joinOverflow(set, bInA, cap, settings, s);
        s.order.resize(cap);
    }
}

}  // namespace

bool hasPoints(const ContactSet& set) noexcept {
    return std::any_of(set.slots.begin(), set.slots.end(), [](const RegionSlot& slot) { return slot.count > 0; });
}

bool refresh(ContactSet& set, const Pose& bInA, const ContactSetSettings& settings) {
    bool allStayed = true;
    for (RegionSlot& slot : set.slots) {
        int count = 0;
        for (int i = 0; i < slot.count; ++i) {
            PersistentPoint point = slot.points[static_cast<std::size_t>(i)];
            const Eigen::Vector3f normal = bInA.rotation * point.normalInB;
            const Eigen::Vector3f apart = point.localA - apply(bInA, point.localB);
            point.signedDistance = normal.dot(apart);
            const Eigen::Vector3f sideways = apart - normal * point.signedDistance;
            ++point.age;
            if (isFinite(point) && point.signedDistance <= settings.maxDistance &&
                sideways.squaredNorm() <= settings.mergeDistance * settings.mergeDistance) {
                slot.points[static_cast<std::size_t>(count++)] = point;
            }
        }
        std::fill(slot.points.begin() + count, slot.points.end(), PersistentPoint{});
        allStayed = allStayed && slot.count == count;
        slot.count = count;
        if (slot.id != 0) {
            summarise(slot, bInA);
        }
    }
    return allStayed;
}

void merge(ContactSet& set, std::span<const SurfaceContact> contacts, const Pose& bInA, bool complete,
           const ContactSetSettings& settings) {
    assert(settings.mergeDistance > 0.0F);
    Scratch& s = threadScratch();
    detail::groupRegions(contacts, settings.regions, s.groups);
    s.regionOf.assign(contacts.size(), none);
    for (std::uint32_t r = 0; r < s.groups.regions.size(); ++r) {
        for (const std::uint32_t member : s.groups.membersOf(r)) {
            s.regionOf[member] = r;
        }
    }
    gatherKept(set, bInA, s);
    findCounterparts(set, contacts, settings, s);
    assignRegions(set, bInA, settings, s);
    assignKept(set, contacts, bInA, complete, settings, s);
    admit(set, bInA, settings, s);

    s.rebuilt.resize(s.plans.size());
    for (const int p : s.order) {
        rebuildSlot(p, set, contacts, bInA, settings, s.rebuilt[static_cast<std::size_t>(p)], s);
    }
    const std::size_t oldSlots = set.slots.size();
    for (std::size_t i = 0; i < oldSlots; ++i) {
        const bool stays = std::find(s.order.begin(), s.order.end(), static_cast<int>(i)) != s.order.end();
        set.slots[i] = stays && s.rebuilt[i].count > 0 ? s.rebuilt[i] : RegionSlot{};
    }
    // New slots in the order of their regions: deepest first.
    std::sort(s.order.begin(), s.order.end());
    for (const int p : s.order) {
        RegionSlot& rebuilt = s.rebuilt[static_cast<std::size_t>(p)];
        if (s.plans[static_cast<std::size_t>(p)].slot != freeSlot || rebuilt.count == 0) {
            continue;
        }
        rebuilt.id = set.nextId++;
        const auto place =
            std::find_if(set.slots.begin(), set.slots.end(), [](const RegionSlot& x) { return x.id == 0; });
        if (place != set.slots.end()) {
            *place = rebuilt;
        } else {
            set.slots.push_back(rebuilt);
        }
    }
}

}  // namespace grapeshot
