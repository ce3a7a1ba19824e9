#include <grapeshot/narrowphase/pair_update.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/detail/purse.hpp>
#include <grapeshot/narrowphase/penetration.hpp>
#include <grapeshot/narrowphase/relative_motion.hpp>

namespace grapeshot {
namespace {

using detail::Purse;
using detail::testPairs;

struct Scratch {
    LeafPairs leafPairs;
    LocalContactSearch search;
    std::vector<SurfaceContact> found;
    std::vector<SurfaceContact> deep;
};

Scratch& threadScratch() {
    thread_local Scratch scratch;
    return scratch;
}

bool isUsable(const PairSettings& settings) {
    const auto isLength = [](float value) { return std::isfinite(value) && value >= 0.0F; };
    return isLength(settings.maxDistance) && isLength(settings.slack) && isLength(settings.reuseMotion) &&
           isLength(settings.set.maxDistance) && isLength(settings.set.mergeDistance) &&
           settings.set.mergeDistance > 0.0F && isLength(settings.set.regions.spacing) &&
           settings.set.regions.spacing > 0.0F && std::isfinite(settings.set.keepCone) &&
           std::isfinite(settings.set.regions.normalCone) && isLength(settings.local.lean);
}

/// Have points that may be contacts now surely moved against each other by no more than `limit` since `before`?
bool movedAtMost(float limit, const MeshModel& a, const MeshModel& b, const Pose& before, const Pose& now,
                 const PairSettings& settings) {
    return movedAtMost(limit, a.tree, b.tree, before, now, settings.maxDistance);
}

/// Do the kept candidates hold every leaf pair within maxDistance?
bool canReuse(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
              const PairState& state) {
    const auto known = [&](const LeafPair& pair) {
        return pair.leafA < a.tree.leaves.size() && pair.leafB < b.tree.leaves.size();
    };
    if (state.candidateDistance < 0.0F || settings.slack <= 0.0F ||
        !std::all_of(state.candidates.begin(), state.candidates.end(), known)) {
        return false;
    }
    return movedAtMost(state.candidateDistance - settings.maxDistance, a, b, state.candidatePose, bInA, settings);
}

/// How far beyond maxDistance leaf pairs are collected, so that the list can be used again: nothing if the bodies move
/// too fast for that.
float slackNow(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
               const PairState& state) {
    const bool slow = state.step <= 1 || movedAtMost(settings.slack, a, b, state.searchPose, bInA, settings);
    return slow ? settings.slack : 0.0F;
}

/// Steps of the first dive into the trees: enough to reach some leaf pairs of a million triangles.
constexpr std::uint64_t diveWork = 16;

/// Traversal and tests in turns, so that a small budget finds some contacts before it knows all candidates: first a
/// dive where the boxes overlap deepest (best first would look at all the large nodes before any leaf), then best
/// first. The turns do not depend on the budget, so a larger one does what a smaller one does, and more. True if all
/// were found.
bool traverseInTurns(Query& traversal, const Pose& bInA, float reach, Purse& purse, Scratch& s) {
    Budget dive = purse.left();
    dive.work = std::min(dive.work, diveWork);
    traversal.leafPairs(bInA, {reach, Order::depthFirst}, dive, s.leafPairs);
    purse.pay(s.leafPairs.work);
    const bool tested = testPairs(s.leafPairs.pairs, purse, s.search);
    if (!tested || s.leafPairs.certain) {
        return tested;
    }
    s.leafPairs.pairs.clear();
    s.leafPairs.certain = false;
    std::size_t testedUntil = 0;
    std::uint64_t traversalWork = 0;
    std::uint64_t turn = 1;
    for (bool started = false; !purse.isEmpty(); started = true) {
        if (!s.leafPairs.certain) {
            Budget slice = purse.left();
            slice.work = std::min(slice.work, turn);
            turn = std::min<std::uint64_t>(2 * turn, 32);
            if (started) {
                traversal.resumeLeafPairs(slice, s.leafPairs);
            } else {
                traversal.leafPairs(bInA, {reach, Order::bestFirst}, slice, s.leafPairs);
            }
            if (s.leafPairs.stop == StopReason::invalidInput) {
                return false;
            }
            purse.pay(s.leafPairs.work - traversalWork);
            traversalWork = s.leafPairs.work;
        }
        const auto fresh = std::span<const LeafPair>(s.leafPairs.pairs).subspan(testedUntil);
        if (!testPairs(fresh, purse, s.search)) {
            break;
        }
        testedUntil = s.leafPairs.pairs.size();
        if (s.leafPairs.certain) {
            break;
        }
    }
    return s.leafPairs.certain && testedUntil == s.leafPairs.pairs.size();
}

/// Feeds the search with all leaf pairs within maxDistance. True if none is missing.
bool searchPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                 PairState& state, PairResult& result, Scratch& s) {
    LocalContactSettings local = settings.local;
    local.maxDistance = std::min(local.maxDistance, settings.maxDistance);
    s.search.start(a, b, bInA, local);
    if (canReuse(a, b, bInA, settings, state)) {
        return testPairs(state.candidates, purse, s.search);
    }
    const float slack = slackNow(a, b, bInA, settings, state);
    const float reach = settings.maxDistance + slack;
    result.traversed = true;
    state.candidatePose = bInA;
    state.candidateDistance = -1;
    state.candidates.clear();
    Query query(a.tree, b.tree);
    bool complete = false;
    if (purse.isUnlimited()) {
        query.leafPairs(bInA, {reach, Order::depthFirst}, purse.left(), s.leafPairs);
        purse.pay(s.leafPairs.work);
        complete = s.leafPairs.certain && testPairs(s.leafPairs.pairs, purse, s.search);
    } else {
        complete = traverseInTurns(query, bInA, reach, purse, s);
    }
    if (s.leafPairs.certain && slack > 0) {
        // Sorted: the state does not tell in which order they were found.
        state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
        std::sort(state.candidates.begin(), state.candidates.end());
        state.candidateDistance = reach;
    }
    return complete;
}

/// Local extrema and the cuts that they do not explain, in s.found. Returns how many are local.
std::size_t finishSearch(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                         Scratch& s) {
    s.found.clear();
    s.search.finish(s.found);
    const std::size_t localCount = s.found.size();
    if (!s.search.overlapping().empty()) {
        s.deep.clear();
        const float spacing = settings.set.regions.spacing;
        penetrationContacts(a, b, bInA, s.search.overlapping(), s.found, {spacing, spacing, maxPointsPerRegion},
                            s.deep);
        s.found.insert(s.found.end(), s.deep.begin(), s.deep.end());
    }
    return localCount;
}

/// All contacts, bodies inside bodies too.
void findContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, bool complete,
                  PairResult& result, Scratch& s) {
    const std::size_t localCount = finishSearch(a, b, bInA, settings, s);
    const bool overlapping = !s.search.overlapping().empty();
    result.candidates = s.search.tested();
    if (!overlapping && complete && settings.interior == Interior::solid && s.found.empty()) {
        containmentContacts(a, b, bInA, s.found);
    }
    result.rawContacts = static_cast<std::uint32_t>(s.found.size());
    result.deepContacts = static_cast<std::uint32_t>(s.found.size() - localCount);
    result.collides = overlapping || std::any_of(s.found.begin(), s.found.end(), [](const SurfaceContact& contact) {
                          return contact.signedDistance <= 0.0F;
                      });
}

/// Does some kept point penetrate?
bool touches(const ContactSet& set) {
    return std::any_of(set.slots.begin(), set.slots.end(), [](const RegionSlot& slot) {
        const auto end = slot.points.begin() + slot.count;
        return std::any_of(slot.points.begin(), end, [](const auto& point) { return point.signedDistance <= 0.0F; });
    });
}

}  // namespace

PairResult update(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget budget,
                  PairState& state) {
    PairResult result;
    ++state.step;
    if (!isRigid(bInA) || !isUsable(settings)) {
        state.contacts.slots.clear();
        state.contacts.droppedRegions = 0;
        state.candidates.clear();
        state.candidateDistance = -1;
        state.searchHolds = false;
        return result;
    }
    const bool allStayed = refresh(state.contacts, bInA, settings.set);
    if (state.searchHolds && allStayed && settings.reuseMotion > 0 && settings.maxDistance <= state.searchDistance &&
        movedAtMost(settings.reuseMotion, a, b, state.searchPose, bInA, settings)) {
        result.collides = touches(state.contacts);
        result.refreshed = result.certain = true;
        result.stop = StopReason::certain;
        return result;
    }
    Scratch& s = threadScratch();
    Purse purse(budget);
    state.searchHolds = false;  // should something be thrown
    const bool complete = searchPairs(a, b, bInA, settings, purse, state, result, s);
    findContacts(a, b, bInA, settings, complete, result, s);
    merge(state.contacts, s.found, bInA, complete, settings.set);
    if (!complete) {
        // Whatever is kept may be incomplete now, and what was left out may be what matters.
        state.candidateDistance = -1;
        result.collides = result.collides || touches(state.contacts);
    }
    state.searchPose = bInA;
    state.searchDistance = settings.maxDistance;
    state.searchHolds = complete && result.deepContacts == 0 && s.search.overlapping().empty();
    result.certain = complete;
    result.stop = complete ? StopReason::certain : StopReason::budget;
    result.work = purse.spent();
    return result;
}

std::uint64_t contactsAt(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                         Budget budget, std::vector<SurfaceContact>& out) {
    if (!isRigid(bInA) || !isUsable(settings)) {
        return 0;
    }
    Scratch& s = threadScratch();
    Purse purse(budget);
    LocalContactSettings local = settings.local;
    local.maxDistance = settings.maxDistance;
    s.search.start(a, b, bInA, local);
    const Order order = purse.isUnlimited() ? Order::depthFirst : Order::bestFirst;
    Query(a.tree, b.tree).leafPairs(bInA, {settings.maxDistance, order}, budget, s.leafPairs);
    purse.pay(s.leafPairs.work);
    testPairs(s.leafPairs.pairs, purse, s.search);
    finishSearch(a, b, bInA, settings, s);
    out.insert(out.end(), s.found.begin(), s.found.end());
    return purse.spent();
}

}  // namespace grapeshot
