#include <grapeshot/narrowphase/detail/pair_search.hpp>

#include <algorithm>
#include <span>

#include <grapeshot/narrowphase/detail/feature_search.hpp>

namespace grapeshot::detail {

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

float slackNow(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
               const PairState& state) {
    const bool slow = state.step <= 1 || movedAtMost(settings.slack, a, b, state.searchPose, bInA, settings);
    return slow ? settings.slack : 0.0F;
}

bool penetrates(const ContactSet& contacts) {
    return std::any_of(contacts.slots.begin(), contacts.slots.end(), [](const RegionSlot& slot) {
        const auto end = slot.points.begin() + slot.count;
        return std::any_of(slot.points.begin(), end, [](const auto& point) { return point.signedDistance <= 0.0F; });
    });
}

void findWitnesses(const MeshModel& a, const MeshModel* b, const ContactSet& contacts, PairSearch& s) {
    s.ranked.clear();
    for (const RegionSlot& slot : contacts.slots) {
        for (int i = 0; i < slot.count; ++i) {
            const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
            if (point.triangleA < a.leafOf.size() && (b == nullptr || point.triangleB < b->leafOf.size())) {
                const std::uint32_t leafB = b != nullptr ? b->leafOf[point.triangleB] : 0;
                s.ranked.push_back({point.signedDistance, {a.leafOf[point.triangleA], leafB}});
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

void forgetCandidates(PairState& state) {
    state.candidates.clear();
    state.candidateDistance = -1;
    state.traversal.reset();
    state.openChildren.clear();
    state.nextCandidate = 0;
}

namespace {

/// As slackNow, for a traversal that will take several steps: enough for a few at the present speed, if that is not too
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

/// A first dive to where the boxes overlap deepest (best first would look at all the large nodes before any leaf), then
/// the traversal is ready to go best first. If the dive has seen everything, there is none.
void beginTraversal(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                    Purse& purse, PairState& state, PairSearch& s) {
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
        tested += testSome(fresh, purse, s.local);
        if (purse.isEmpty()) {
            break;
        }
    }
    state.traversalWork = 0;
    state.traversal->leafPairs(bInA, {state.traversalDistance, Order::bestFirst}, {.work = 0}, s.leafPairs);
}

/// Up to `most` more units of the traversal. False if it cannot go on.
bool goOnTraversing(std::uint64_t most, Purse& purse, PairState& state, PairSearch& s) {
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
bool testUntil(std::size_t end, Purse& purse, PairState& state, PairSearch& s) {
    const auto rest =
        std::span<const LeafPair>(state.candidates).subspan(state.nextCandidate, end - state.nextCandidate);
    state.nextCandidate += testSome(rest, purse, s.local);
    return state.nextCandidate == end;
}

/// Traversal and tests in turns, so that a small budget finds some contacts before it knows all candidates. The turns
/// do not depend on the budget, so a larger one does what a smaller one does, and more. True if all were found and
/// tested.
bool searchInTurns(Purse& purse, PairState& state, PairSearch& s) {
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
                  PairState& state, PairResult& result, PairSearch& s) {
    findWitnesses(a, &b, state.contacts, s);
    const std::uint64_t before = s.local.work();
    s.local.add(s.witnesses, purse.left().work / 2);
    purse.pay(s.local.work() - before);
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

}  // namespace

bool testCandidates(Purse& purse, PairState& state, PairSearch& s) {
    if (purse.isUnlimited()) {
        state.nextCandidate = 0;
        return testPairs(state.candidates, purse, s.local);
    }
    return searchInTurns(purse, state, s);
}

bool searchPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                 PairState& state, PairResult& result, PairSearch& s) {
    LocalContactSettings wanted = settings.local;
    wanted.maxDistance = std::min(wanted.maxDistance, settings.maxDistance);
    s.local.start(a, b, bInA, wanted);
    if (settings.method == Method::scf && a.features && b.features) {
        return searchFeatures(a, b, bInA, settings, purse, state, result, s);
    }
    if (!purse.isUnlimited()) {
        return searchWithin(a, b, bInA, settings, purse, state, result, s);
    }
    if (canReuse(a, b, bInA, settings, state)) {
        return testCandidates(purse, state, s);
    }
    const float slack = slackNow(a, b, bInA, settings, state);
    const float reach = settings.maxDistance + slack;
    result.traversed = true;
    forgetCandidates(state);
    state.candidatePose = bInA;
    Query(a.tree, b.tree).leafPairs(bInA, {reach, Order::depthFirst}, purse.left(), s.leafPairs);
    purse.pay(s.leafPairs.work);
    const bool complete = s.leafPairs.certain && testPairs(s.leafPairs.pairs, purse, s.local);
    if (s.leafPairs.certain && slack > 0) {
        state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
        std::sort(state.candidates.begin(), state.candidates.end());
        state.candidateDistance = reach;
    }
    return complete;
}

}  // namespace grapeshot::detail
