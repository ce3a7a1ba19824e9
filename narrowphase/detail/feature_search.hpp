// Method::scf: where two meshes are near, by their ball trees.
#pragma once

#include <grapeshot/narrowphase/detail/pair_search.hpp>

namespace grapeshot::detail {

/// As searchPairs. Three ways, whichever is enough: the candidates of an earlier step; the exact traversal, if the last
/// ones took no more than they may; else the tracker, from whose contacts the search walks over the neighbourhood.
/// @pre both models have `features`
bool searchFeatures(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                    Purse& purse, PairState& state, PairResult& result, PairSearch& search);

/// All leaf pairs within `reach` by the exact traversal, ascending, in `out`. False if the budget ended before.
/// @pre both models have `features`
bool closeLeafPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, float reach, const Budget& budget,
                    PairSearch& search, std::vector<LeafPair>& out, std::uint64_t& work);

}  // namespace grapeshot::detail
