// A running scene as bytes: saved, and gone on with in a world that is built anew.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <grapeshot/plugin/precision.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionWorld;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Replaces `out` by all that changes from step to step and that a Bullet program cannot save by itself. Between steps.
///
/// In it are, of each body in the world's order: pose, velocities, what it would be interpolated from, forces applied
/// since the last step, sleep; all pairs of the broadphase in their order; of each pair of ours (but for children of
/// compounds): its contacts and their names, kept candidates, searches under way, age, manifolds with impulses and
/// their place in the dispatcher's list.
///
/// Not in it: what does not change by itself (shapes, masses, filters, settings: build them as before); joints'
/// impulses; soft bodies and multi-bodies; contacts that Bullet's own algorithms keep, and ours within compounds, which
/// begin anew; user pointers on contact points; the fraction of a substep that stepSimulation keeps.
/// @return nullPointer, badArgument (the world's dispatcher is no btCollisionDispatcher, or its pair cache no
/// btHashedOverlappingPairCache), notRegistered, outOfMemory; stillBuilding: a pair has but a stand-in for one of its
/// meshes (see prebuild): step on until the tree is there, or prebuild and step once. `out` is empty then.
/// O(triangles): meshes are hashed.
Status saveState(btCollisionWorld* world, std::vector<std::byte>& out) noexcept;

/// Into a world with the same bodies in the same order (added in that order, so that broadphase ids are in order too),
/// registered with the same settings, of the same precision. Pairs and contacts that are there are replaced; callbacks
/// for contacts are not called. Trees that are missing are built, those on their way finished.
///
/// The steps that follow give the same bytes as in the world that was saved, if all contacts are ours, joints are none,
/// and the broadphase has no memory (btSimpleBroadphase), or pairs are processed in a fixed order
/// (m_deterministicOverlappingPairs) and its memory changes nothing: btDbvtBroadphase keeps pairs that have parted for
/// a while, which may join islands, have a part in a frame's budget, or come back with what they knew; and, under a
/// limited frameBudget, all meshes of both worlds were prebuilt, since who meets a new one pays for its tree. Else they
/// are as good, but not the same.
/// @return as saveState; badState: the bytes are no saved state, are cut off or changed, or of another version or
/// precision; otherWorld: other bodies, shapes, meshes or filters. Then nothing is changed. outOfMemory: pairs may be
/// missing, and are found anew.
Status restoreState(btCollisionWorld* world, std::span<const std::byte> bytes) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
