#include <grapeshot/narrowphase/pair_update.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <grapeshot/narrowphase/detail/purse.hpp>
#include <grapeshot/narrowphase/penetration.hpp>
#include <grapeshot/narrowphase/relative_motion.hpp>
#include <grapeshot/narrowphase/stand_in.hpp>

namespace grapeshot {
namespace {

using detail::Purse;
using detail::testPairs;
using detail::testSome;

struct Scratch {
    LeafPairs leafPairs;
    std::vector<LeafPair> witnesses;
    std::vector<std::pair<float, LeafPair>> ranked;
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

/// The same for a traversal that will take several steps: enough for a few at the present speed, if that is not too
/// far.
float slackAhead(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                 const PairState& state) {
    if (state.step <= 1) {
        return settings.slack;
    }
    for (const float times : {1.0F, 2.0F, 4.0F, 8.0F}) {
        if (movedAtMost(times / 3 * settings.slack, a, b, state.searchPose, bInA, settings)) {
            return times * settings.slack;
        }
    }
    return 0;
}

/// Steps of the first dive into the trees: enough to reach some leaf pairs of a million triangles.
constexpr std::uint64_t diveWork = 16;
/// Between two looks at what it has found.
constexpr std::uint64_t diveStride = 4;

/// The leaf pairs of the kept points, deepest first, in s.witnesses.
void findWitnesses(const MeshModel& a, const MeshModel& b, const ContactSet& contacts, Scratch& s) {
    s.ranked.clear();
    for (const RegionSlot& slot : contacts.slots) {
        for (int i = 0; i < slot.count; ++i) {
            const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
            if (point.triangleA < a.leafOf.size() && point.triangleB < b.leafOf.size()) {
                s.ranked.push_back({point.signedDistance, {a.leafOf[point.triangleA], b.leafOf[point.triangleB]}});
            }
        }
    }
    std::sort(s.ranked.begin(), s.ranked.end());
    s.witnesses.clear();
    for (const auto& [distance, pair] : s.ranked) {
        if (std::find(s.witnesses.begin(), s.witnesses.end(), pair) == s.witnesses.end()) {
            s.witnesses.push_back(pair);
        }
    }
}

/// A first dive to where the boxes overlap deepest (best first would look at all the large nodes before any leaf), then
/// the traversal is ready to go best first. If the dive has seen everything, there is none.
void beginTraversal(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                    Purse& purse, PairState& state, Scratch& s) {
    state.traversalDistance = settings.maxDistance + slackAhead(a, b, bInA, settings, state);
    state.candidatePose = bInA;
    state.candidateDistance = -1;
    state.candidates.clear();
    state.nextCandidate = 0;
    state.traversalWork = 0;
    state.traversal.emplace(a.tree, b.tree);
    std::size_t tested = 0;
    for (std::uint64_t dived = 0; dived < diveWork; dived += diveStride) {
        Budget dive = purse.left();
        dive.work = std::min(dive.work, diveStride);
        if (dived == 0) {
            state.traversal->leafPairs(bInA, {state.traversalDistance, Order::depthFirst}, dive, s.leafPairs);
        } else {
            state.traversal->resumeLeafPairs(dive, s.leafPairs);
        }
        purse.pay(s.leafPairs.work - state.traversalWork);
        state.traversalWork = s.leafPairs.work;
        if (s.leafPairs.certain) {
            state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
            state.traversal.reset();
            return;
        }
        const auto fresh = std::span<const LeafPair>(s.leafPairs.pairs).subspan(tested);
        tested += testSome(fresh, purse, s.search);
        if (purse.isEmpty()) {
            break;
        }
    }
    state.traversalWork = 0;
    state.traversal->leafPairs(bInA, {state.traversalDistance, Order::bestFirst}, {.work = 0}, s.leafPairs);
}

/// Up to `most` more units of the traversal. False if it cannot go on.
bool goOnTraversing(std::uint64_t most, Purse& purse, PairState& state, Scratch& s) {
    Budget slice = purse.left();
    slice.work = std::min(slice.work, most);
    s.leafPairs.pairs.clear();
    state.traversal->resumeLeafPairs(slice, s.leafPairs);
    if (s.leafPairs.stop == StopReason::invalidInput) {
        return false;
    }
    purse.pay(s.leafPairs.work - state.traversalWork);
    state.traversalWork = s.leafPairs.work;
    state.candidates.insert(state.candidates.end(), s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
    if (s.leafPairs.certain) {
        state.traversal.reset();
    }
    return true;
}

/// Tests candidates up to `end` from where the last ones stopped. False if the budget ended it.
bool testUntil(std::size_t end, Purse& purse, PairState& state, Scratch& s) {
    const auto rest =
        std::span<const LeafPair>(state.candidates).subspan(state.nextCandidate, end - state.nextCandidate);
    state.nextCandidate += testSome(rest, purse, s.search);
    return state.nextCandidate == end;
}

/// Traversal and tests in turns, so that a small budget finds some contacts before it knows all candidates. The turns
/// do not depend on the budget, so a larger one does what a smaller one does, and more. True if all were found and
/// tested.
bool searchInTurns(Purse& purse, PairState& state, Scratch& s) {
    state.nextCandidate = std::min(state.nextCandidate, state.candidates.size());
    const std::size_t first = state.nextCandidate;
    for (std::uint64_t turn = 1;; turn = std::min<std::uint64_t>(2 * turn, 32)) {
        if (!testUntil(state.candidates.size(), purse, state, s)) {
            return false;
        }
        if (!state.traversal) {
            break;
        }
        if (purse.isEmpty() || !goOnTraversing(turn, purse, state, s)) {
            return false;
        }
    }
    state.nextCandidate = 0;
    return testUntil(first, purse, state, s);
}

/// With a budget: first what is known, then on where the last step stopped.
bool searchWithin(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                  PairState& state, PairResult& result, Scratch& s) {
    findWitnesses(a, b, state.contacts, s);
    const std::uint64_t before = s.search.work();
    s.search.add(s.witnesses, purse.left().work / 2);
    purse.pay(s.search.work() - before);
    bool listed = canReuse(a, b, bInA, settings, state);
    if (!listed) {
        result.traversed = true;
        const bool goesOn =
            state.traversal && state.traversalDistance >= settings.maxDistance &&
            movedAtMost(state.traversalDistance - settings.maxDistance, a, b, state.candidatePose, bInA, settings);
        if (!goesOn) {
            beginTraversal(a, b, bInA, settings, purse, state, s);
        }
    }
    const bool complete = searchInTurns(purse, state, s);
    if (!listed && !state.traversal) {
        // Sorted: the state does not tell in which order they were found.
        std::sort(state.candidates.begin(), state.candidates.end());
        state.nextCandidate = 0;
        state.candidateDistance = state.traversalDistance;
        if (complete && state.traversalDistance <= settings.maxDistance) {
            state.candidates.clear();
            state.candidateDistance = -1;
        }
    }
    return complete;
}

/// Feeds the search with all leaf pairs within maxDistance. True if none is missing.
bool searchPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                 PairState& state, PairResult& result, Scratch& s) {
    LocalContactSettings local = settings.local;
    local.maxDistance = std::min(local.maxDistance, settings.maxDistance);
    s.search.start(a, b, bInA, local);
    if (!purse.isUnlimited()) {
        return searchWithin(a, b, bInA, settings, purse, state, result, s);
    }
    if (canReuse(a, b, bInA, settings, state)) {
        state.nextCandidate = 0;
        return testPairs(state.candidates, purse, s.search);
    }
    const float slack = slackNow(a, b, bInA, settings, state);
    const float reach = settings.maxDistance + slack;
    result.traversed = true;
    forgetSearch(state);
    state.candidatePose = bInA;
    Query(a.tree, b.tree).leafPairs(bInA, {reach, Order::depthFirst}, purse.left(), s.leafPairs);
    purse.pay(s.leafPairs.work);
    const bool complete = s.leafPairs.certain && testPairs(s.leafPairs.pairs, purse, s.search);
    if (s.leafPairs.certain && slack > 0) {
        state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
        std::sort(state.candidates.begin(), state.candidates.end());
        state.candidateDistance = reach;
    }
    return complete;
}

/// Half a cut tells the wrong direction, along which bodies are deep in each other: such a contact pushes no more than
/// what parts the deepest two triangles.
void restrain(std::span<const TriangleContact> overlapping, std::span<SurfaceContact> deep) {
    float least = 0;
    for (const TriangleContact& pair : overlapping) {
        least = std::min(least, pair.signedDistance);
    }
    for (SurfaceContact& contact : deep) {
        contact.signedDistance = std::max(contact.signedDistance, least);
        contact.onA = contact.onB + contact.normal * contact.signedDistance;
    }
}

/// Local extrema and the cuts that they do not explain, in s.found. Returns how many are local.
std::size_t finishSearch(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                         bool complete, Scratch& s) {
    s.found.clear();
    s.search.finish(s.found);
    const std::size_t localCount = s.found.size();
    if (!s.search.overlapping().empty()) {
        s.deep.clear();
        const float spacing = settings.set.regions.spacing;
        penetrationContacts(a, b, bInA, s.search.overlapping(), s.found, {spacing, spacing, maxPointsPerRegion},
                            s.deep);
        if (!complete) {
            restrain(s.search.overlapping(), s.deep);
        }
        s.found.insert(s.found.end(), s.deep.begin(), s.deep.end());
    }
    return localCount;
}

/// All contacts, bodies inside bodies too.
void findContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, bool complete,
                  PairResult& result, Scratch& s) {
    const std::size_t localCount = finishSearch(a, b, bInA, settings, complete, s);
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

bool hasPoints(const ContactSet& set) {
    return std::any_of(set.slots.begin(), set.slots.end(), [](const RegionSlot& slot) { return slot.count > 0; });
}

/// Does some kept point penetrate?
bool touches(const ContactSet& set) {
    return std::any_of(set.slots.begin(), set.slots.end(), [](const RegionSlot& slot) {
        const auto end = slot.points.begin() + slot.count;
        return std::any_of(slot.points.begin(), end, [](const auto& point) { return point.signedDistance <= 0.0F; });
    });
}

/// As long as a pair is cut short, its points are let slide farther before they are dropped: by so many times the
/// usual. What held a body a step ago is the best guess at what holds it now.
constexpr float slidingEvidence = 8;

/// What is kept of a budget for a stand-in: if what is known may not be what holds the bodies apart, and the last call
/// was not for the same pose.
std::uint64_t standInReserve(const Pose& bInA, const Budget& budget, const PairState& state) {
    const bool known = state.step > 1 && bInA.rotation == state.searchPose.rotation &&
                       bInA.translation == state.searchPose.translation;
    if (Purse(budget).isUnlimited() || (known && state.cutShort)) {
        return 0;
    }
    const bool bare = !hasPoints(state.contacts);
    if (budget.work >= 2 * standInWork) {
        return bare || state.cutShort ? standInWork : 0;
    }
    return bare ? budget.work / 2 : 0;
}

}  // namespace

PairResult update(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget budget,
                  PairState& state) {
    PairResult result;
    ++state.step;
    if (!isRigid(bInA) || !isUsable(settings)) {
        state.contacts.slots.clear();
        state.contacts.droppedRegions = 0;
        forgetSearch(state);
        return result;
    }
    const std::uint64_t reserve = standInReserve(bInA, budget, state);
    if (reserve > 0) {
        dropStandIns(state.contacts);
    }
    ContactSetSettings staying = settings.set;
    if (state.cutShort && !Purse(budget).isUnlimited()) {
        staying.mergeDistance *= slidingEvidence;
    }
    const bool allStayed = refresh(state.contacts, bInA, staying);
    if (state.searchHolds && allStayed && settings.reuseMotion > 0 && settings.maxDistance <= state.searchDistance &&
        movedAtMost(settings.reuseMotion, a, b, state.searchPose, bInA, settings)) {
        result.collides = touches(state.contacts);
        result.refreshed = result.certain = true;
        result.stop = StopReason::certain;
        return result;
    }
    Scratch& s = threadScratch();
    Budget ofSearch = budget;
    ofSearch.work -= budget.work != unlimited ? reserve : 0;
    Purse purse(ofSearch);
    state.searchHolds = false;  // should something be thrown
    const bool complete = searchPairs(a, b, bInA, settings, purse, state, result, s);
    findContacts(a, b, bInA, settings, complete, result, s);
    if (!complete && reserve > 0) {
        const std::size_t before = s.found.size();
        purse.pay(standInContact(a, b, bInA, settings.set.regions, settings.maxDistance / 4, reserve, s.found));
        result.collides = result.collides || s.found.size() > before;
    }
    merge(state.contacts, s.found, bInA, complete, settings.set);
    if (!complete) {
        result.collides = result.collides || touches(state.contacts);
    }
    state.cutShort = !complete;
    state.searchPose = bInA;
    state.searchDistance = settings.maxDistance;
    state.searchHolds = complete && result.deepContacts == 0 && s.search.overlapping().empty();
    result.certain = complete;
    result.stop = complete ? StopReason::certain : StopReason::budget;
    result.work = purse.spent();
    return result;
}

void forgetSearch(PairState& state) {
    state.candidates.clear();
    state.candidateDistance = -1;
    state.traversal.reset();
    state.nextCandidate = 0;
    state.searchHolds = false;
    state.cutShort = false;
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
    const bool complete = testPairs(s.leafPairs.pairs, purse, s.search) && s.leafPairs.certain;
    finishSearch(a, b, bInA, settings, complete, s);
    out.insert(out.end(), s.found.begin(), s.found.end());
    return purse.spent();
}

}  // namespace grapeshot
