// One step of a mesh against a plane or convex solid, within a budget: what update (pair_update.hpp) is for two meshes.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/pair_update.hpp>
#include <grapeshot/narrowphase/solid.hpp>

namespace grapeshot {

/// Refresh, search, merge. Unlimited, all leaves near the solid are asked for anew. With a limit first those of the
/// kept points, deepest first, for at most half of it; then the tree is traversed, what is deepest in the solid first,
/// and the leaves tested in turns, both from where the last call stopped, in the same step or the next, as long as the
/// bodies move by no more than the slack. So the deepest place is found with the first few units. Where contacts take
/// all leaves (Solid::standInWork) and there are none at all, up to half of the budget goes into a stand-in. Enough
/// budget gives the contacts of an unlimited one. Work: a unit for four nodes, and as the functions of
/// convex_contacts.hpp count; never more than the budget.
///
/// Out of budget: what was found is merged, kept points stay, `certain` is false. On invalidInput (NaN or non-rigid
/// pose) the contacts stay as they are. `solid` is placed at `pose`, both in the mesh's frame.
PairResult updateSolid(const MeshModel& mesh, const Solid& solid, const Pose& pose, const PairSettings& settings,
                       Budget budget, PairState& state);

/// The contacts of one pose without memory, appended to `out`; returns the work.
std::uint64_t solidContactsAt(const MeshModel& mesh, const Solid& solid, const LocalContactSettings& settings,
                              Budget budget, std::vector<SurfaceContact>& out);

}  // namespace grapeshot
