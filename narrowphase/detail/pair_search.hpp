// Which leaf pairs of two meshes are tested in a step, and in what order, within a budget; kept and gone on with from
// step to step.
#pragma once

#include <utility>
#include <vector>

#include <grapeshot/narrowphase/detail/budgeted_tests.hpp>
#include <grapeshot/narrowphase/detail/patch_walk.hpp>
#include <grapeshot/narrowphase/pair_update.hpp>
#include <grapeshot/narrowphase/relative_motion.hpp>
#include <grapeshot/scf/close_leaves.hpp>

namespace grapeshot::detail {

/// What a search works on; nothing of it lasts from step to step.
struct PairSearch {
    LocalContactSearch local;
    LeafPairs leafPairs;
    std::vector<LeafPair> witnesses;
    std::vector<std::pair<float, LeafPair>> ranked;
    PatchWalk walk;
    CloseLeafSearch closeLeaves;
    std::vector<CloseLeaves> close;
    TrackResult tracked;
};

/// Feeds `search.local`, started anew, with all leaf pairs within maxDistance. True if none is missing.
bool searchPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                 PairState& state, PairResult& result, PairSearch& search);

// Parts that the methods share.

/// Do the kept candidates hold every leaf pair within maxDistance?
[[nodiscard]] bool canReuse(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                            const PairState& state);
/// How far beyond maxDistance leaf pairs are collected, so that the list can be used again: nothing if the bodies move
/// too fast for that.
[[nodiscard]] float slackNow(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                             const PairState& state);
/// The leaf pairs of the kept points, deepest first, in s.witnesses; with a solid (no B) those of A with leaf 0.
void findWitnesses(const MeshModel& a, const MeshModel* b, const ContactSet& contacts, PairSearch& s);
/// The kept candidates, from where the last tests stopped. True if all were tested.
bool testCandidates(Purse& purse, PairState& state, PairSearch& s);
/// They are not known any more.
void forgetCandidates(PairState& state);
/// Does some kept point penetrate?
[[nodiscard]] bool penetrates(const ContactSet& contacts);
/// As long as a pair is cut short, its points are let slide farther before they are dropped: by so many times the
/// usual. What held a body a step ago is the best guess at what holds it now.
inline constexpr float slidingEvidence = 8;

/// Have points that may be contacts now surely moved against each other by no more than `limit` since `before`?
inline bool movedAtMost(float limit, const MeshModel& a, const MeshModel& b, const Pose& before, const Pose& now,
                        const PairSettings& settings) {
    return movedAtMost(limit, a.tree, b.tree, before, now, settings.maxDistance);
}

}  // namespace grapeshot::detail
