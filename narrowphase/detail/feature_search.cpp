#include <grapeshot/narrowphase/detail/feature_search.hpp>

#include <algorithm>
#include <limits>

namespace grapeshot::detail {
namespace {

/// A step of the tracker may exceed its budget by so much.
constexpr std::uint64_t trackerExcess = 40;
/// Work units of a step of the tracker below which nothing new is found.
constexpr std::uint64_t leastTracking = 24;
/// Pieces of each surface that samples are drawn from. Of rigid bodies few: the candidates are listed in every step.
constexpr std::uint32_t rigidFrontCells = 64;

SurfaceState stateOf(const MeshModel& model, const Pose* pose) {
    SurfaceState state;
    if (pose != nullptr) {
        state.pose = *pose;
    }
    state.stretch = Stretch::rigid();
    if (model.featureStretch > 0) {
        state.positions = model.tree.vertices;
        state.stretch = Stretch::given(model.featureStretch);
    }
    return state;
}

TrackSettings trackSettings(const PairSettings& settings) {
    TrackSettings track;
    track.maxDistance = settings.maxDistance;
    track.spacing = settings.set.regions.spacing / 2;
    track.followDistance = settings.maxDistance;
    track.frontCells = rigidFrontCells;
    track.keepFront = false;  // while bodies hardly move, their pairs of leaves are kept, and no step is made
    track.seed = settings.features.seed;
    track.pair = settings.features.pair;
    return track;
}

/// Features from step to step; from each, and from what the traversal has found, all that hangs together with it.
bool track(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Budget share,
           Purse& purse, PairState& state, PairResult& result, PairSearch& s) {
    result.sampled = true;
    result.missBound = std::numeric_limits<double>::infinity();
    findWitnesses(a, &b, state.contacts, s);
    s.walk.start(a, b);
    for (const LeafPair& witness : s.witnesses) {
        s.walk.seed(witness);
    }
    for (const LeafPair& pair : s.leafPairs.pairs) {
        s.walk.seed(pair);
    }
    if (share.work < trackerExcess + leastTracking) {
        return s.walk.run(purse, s.local) && purse.isUnlimited();
    }
    if (!state.tracker) {
        state.tracker.emplace(a.features->balls, b.features->balls);
    }
    share.work -= share.work == unlimited ? 0 : trackerExcess;
    state.tracker->step(stateOf(a, nullptr), stateOf(b, &bInA), trackSettings(settings), share, s.tracked);
    purse.pay(s.tracked.work);
    result.missBound = s.tracked.miss.missedBound;
    for (const TrackedContact& contact : s.tracked.contacts) {
        s.walk.seed({a.leafOf[contact.pair.triangleA], b.leafOf[contact.pair.triangleB]});
    }
    return s.walk.run(purse, s.local) && s.tracked.stop != StopReason::invalidInput;
}

}  // namespace

bool closeLeafPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, float reach, const Budget& budget,
                    const RandomKey& order, PairSearch& s, std::vector<LeafPair>& out, std::uint64_t& work) {
    const CloseLeafResult found = s.closeLeaves.find(a.features->balls, stateOf(a, nullptr), b.features->balls,
                                                     stateOf(b, &bInA), reach, budget, order, s.close);
    work = found.work;
    out.clear();
    for (const CloseLeaves& close : s.close) {
        for (const FeatureModel::Share& blockA : a.features->sharesOf(close.leafA)) {
            std::uint32_t lanesB = 0;
            for (unsigned lane = 0; lane < 16; ++lane) {
                lanesB |= (blockA.lanes >> lane & 1U) != 0 ? close.row[lane] : 0U;
            }
            if (lanesB == 0) {
                continue;
            }
            for (const FeatureModel::Share& blockB : b.features->sharesOf(close.leafB)) {
                if ((blockB.lanes & lanesB) != 0) {
                    out.push_back({blockA.block, blockB.block});
                }
            }
        }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return found.complete;
}

bool searchFeatures(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                    Purse& purse, PairState& state, PairResult& result, PairSearch& s) {
    result.method = Method::scf;
    if (canReuse(a, b, bInA, settings, state)) {
        return testCandidates(purse, state, s);
    }
    result.traversed = true;
    Budget share = purse.left();
    share.work = settings.features.searchWork;
    if (!purse.isUnlimited()) {
        share.work = std::min(share.work, purse.left().work / 2);  // what is found wants to be tested
    }
    Budget ofTraversal = share;
    if (share.work != unlimited) {
        share.work /= 2;
        if (share.work < trackerExcess + leastTracking) {
            share.work = 0;
        } else {
            ofTraversal.work = share.work;
        }
    }
    const float reach = settings.maxDistance + slackNow(a, b, bInA, settings, state);
    forgetCandidates(state);
    std::uint64_t work = 0;
    const RandomKey order{settings.features.seed, settings.features.pair, state.step};
    const bool complete = closeLeafPairs(a, b, bInA, reach, ofTraversal, order, s, s.leafPairs.pairs, work);
    purse.pay(work);
    if (complete) {
        state.candidates.assign(s.leafPairs.pairs.begin(), s.leafPairs.pairs.end());
        state.candidatePose = bInA;
        state.candidateDistance = reach;
        return testCandidates(purse, state, s);
    }
    share.time = purse.left().time;
    return track(a, b, bInA, settings, share, purse, state, result, s);
}

}  // namespace grapeshot::detail
