// Method::scf: where two meshes are near, by their ball trees.
#pragma once

#include <grapeshot/narrowphase/detail/pair_search.hpp>

namespace grapeshot::detail {

/// As searchPairs. Three ways, whichever is enough: the candidates of an earlier step; the traversal, if it gets to its
/// end; else the tracker, too. From what these two have found the search walks over the neighbourhood.
/// @pre both models have `features`
bool searchFeatures(const MeshModel& a, const MeshModel& b, const Pose& bInA, const PairSettings& settings,
                    Purse& purse, PairState& state, PairResult& result, PairSearch& search);

/// Leaf pairs within `reach` by the traversal, ascending, in `out`. False if the budget ended before it had all.
/// @pre both models have `features`
bool closeLeafPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, float reach, const Budget& budget,
                    const RandomKey& order, PairSearch& search, std::vector<LeafPair>& out, std::uint64_t& work);

}  // namespace grapeshot::detail
