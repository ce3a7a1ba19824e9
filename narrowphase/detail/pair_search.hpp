// Which leaf pairs of two meshes are tested in a step, and in what order, within a budget; kept and gone on with from
// step to step.
#pragma once

#include <utility>
#include <vector>

#include <grapeshot/narrowphase/detail/budgeted_tests.hpp>
#include <grapeshot/narrowphase/pair_update.hpp>
#include <grapeshot/narrowphase/relative_motion.hpp>

namespace grapeshot::detail {

/// What a search works on; nothing of it lasts from step to step.
struct PairSearch {
    LocalContactSearch local;
    LeafPairs leafPairs;
    std::vector<LeafPair> witnesses;
    std::vector<std::pair<float, LeafPair>> ranked;
};

/// Feeds `search.local`, started anew, with all leaf pairs within maxDistance. True if none is missing.
bool searchPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings, Purse& purse,
                 PairState& state, PairResult& result, PairSearch& search);

/// Have points that may be contacts now surely moved against each other by no more than `limit` since `before`?
inline bool movedAtMost(float limit, const MeshModel& a, const MeshModel& b, const Pose& before, const Pose& now,
                        const PairSettings& settings) {
    return movedAtMost(limit, a.tree, b.tree, before, now, settings.maxDistance);
}

}  // namespace grapeshot::detail
