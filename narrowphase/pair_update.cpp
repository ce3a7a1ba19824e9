#include <grapeshot/narrowphase/pair_update.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/detail/feature_search.hpp>
#include <grapeshot/narrowphase/detail/pair_search.hpp>
#include <grapeshot/narrowphase/penetration.hpp>
#include <grapeshot/narrowphase/stand_in.hpp>

namespace grapeshot {
namespace {

using detail::movedAtMost;

struct Scratch {
    detail::PairSearch search;
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
    s.search.local.finish(s.found);
    const std::size_t localCount = s.found.size();
    if (!s.search.local.overlapping().empty()) {
        s.deep.clear();
        const float spacing = settings.set.regions.spacing;
        penetrationContacts(a, b, bInA, s.search.local.overlapping(), s.found, {spacing, spacing, maxPointsPerRegion},
                            s.deep);
        if (!complete) {
            restrain(s.search.local.overlapping(), s.deep);
        }
        s.found.insert(s.found.end(), s.deep.begin(), s.deep.end());
    }
    return localCount;
}

/// All contacts, bodies inside bodies too.
void findContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, bool complete,
                  PairResult& result, Scratch& s) {
    const std::size_t localCount = finishSearch(a, b, bInA, settings, complete, s);
    const bool overlapping = !s.search.local.overlapping().empty();
    result.candidates = s.search.local.tested();
    if (!overlapping && complete && settings.interior == Interior::solid && s.found.empty()) {
        containmentContacts(a, b, bInA, s.found);
    }
    result.rawContacts = static_cast<std::uint32_t>(s.found.size());
    result.deepContacts = static_cast<std::uint32_t>(s.found.size() - localCount);
    result.collides = overlapping || std::any_of(s.found.begin(), s.found.end(), [](const SurfaceContact& contact) {
                          return contact.signedDistance <= 0.0F;
                      });
}

bool byFeatures(const MeshModel& a, const MeshModel& b, const PairSettings& settings) {
    return settings.method == Method::scf && a.features && b.features;
}

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
    // The stand-in is an estimate of adb's.
    const std::uint64_t reserve = byFeatures(a, b, settings) ? 0 : standInReserve(bInA, budget, state);
    if (reserve > 0) {
        dropStandIns(state.contacts);
    }
    ContactSetSettings staying = settings.set;
    if (state.cutShort && !Purse(budget).isUnlimited()) {
        staying.mergeDistance *= detail::slidingEvidence;
    }
    const bool allStayed = refresh(state.contacts, bInA, staying);
    if (state.searchHolds && allStayed && settings.reuseMotion > 0 && settings.maxDistance <= state.searchDistance &&
        movedAtMost(settings.reuseMotion, a, b, state.searchPose, bInA, settings)) {
        result.method = byFeatures(a, b, settings) ? Method::scf : Method::adb;
        result.collides = detail::penetrates(state.contacts);
        result.refreshed = result.certain = true;
        result.stop = StopReason::certain;
        return result;
    }
    Scratch& s = threadScratch();
    Budget ofSearch = budget;
    ofSearch.work -= budget.work != unlimited ? reserve : 0;
    Purse purse(ofSearch);
    state.searchHolds = false;  // should something be thrown
    const bool complete = detail::searchPairs(a, b, bInA, settings, purse, state, result, s.search);
    findContacts(a, b, bInA, settings, complete, result, s);
    if (!complete && reserve > 0) {
        const std::size_t before = s.found.size();
        purse.pay(standInContacts(a, b, bInA, settings.set.regions, settings.maxDistance / 4, reserve, s.found));
        result.collides = result.collides || s.found.size() > before;
    }
    merge(state.contacts, s.found, bInA, complete, settings.set);
    if (!complete) {
        result.collides = result.collides || detail::penetrates(state.contacts);
    }
    state.cutShort = !complete;
    state.searchPose = bInA;
    state.searchDistance = settings.maxDistance;
    result.certain = complete && !result.sampled;
    result.stop = result.certain ? StopReason::certain : complete ? StopReason::probability : StopReason::budget;
    state.searchHolds = result.certain && result.deepContacts == 0 && s.search.local.overlapping().empty();
    result.work = purse.spent();
    return result;
}

void forgetSearch(PairState& state) {
    detail::forgetCandidates(state);
    state.tracker.reset();
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
    s.search.local.start(a, b, bInA, local);
    std::vector<LeafPair>& pairs = s.search.leafPairs.pairs;
    bool complete = false;
    if (byFeatures(a, b, settings)) {
        std::uint64_t work = 0;
        complete = detail::closeLeafPairs(a, b, bInA, settings.maxDistance, budget, {}, s.search, pairs, work);
        purse.pay(work);
    } else {
        const Order order = purse.isUnlimited() ? Order::depthFirst : Order::bestFirst;
        Query(a.tree, b.tree).leafPairs(bInA, {settings.maxDistance, order}, budget, s.search.leafPairs);
        purse.pay(s.search.leafPairs.work);
        complete = s.search.leafPairs.certain;
    }
    complete = detail::testPairs(pairs, purse, s.search.local) && complete;
    finishSearch(a, b, bInA, settings, complete, s);
    out.insert(out.end(), s.found.begin(), s.found.end());
    return purse.spent();
}

}  // namespace grapeshot
