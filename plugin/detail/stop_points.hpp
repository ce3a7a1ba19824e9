// What keeps a fast body on its side of a surface, beyond the place where it touches first.
//
// A body that is hit at a corner turns about it, and its middle goes on: at 100 m/s within one step through any wall.
// The solver knows no more than the contacts that it is given. So points around the smaller body are not to pass the
// tangent plane of the first touch in this step, as far as there is a surface to meet, nor to come so near to it that
// the body turns by more than the solver's straight ways are good for.
#pragma once

#include <cstdint>

#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/plugin/detail/pair_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Work of `stopPoints`, units.
inline constexpr std::uint64_t stopWork = 16;

struct FirstTouch {
    SurfaceContact contact;  ///< at the pose `then`, A's frame
    Pose then;               ///< of B in A's frame, at the last moment before
    Pose now;
    Eigen::Vector3f normalNow;  ///< the contact's, A's frame now
};

/// Up to four points, in the slot: those farthest to four sides across the normal (of 64 vertices of the mesh, all over
/// it) that are above a surface of the other body when it touches; named by the triangles that touch. A solid counts as
/// wide as its box.
void stopPoints(const PairShapes& shapes, const PairSize& size, const FirstTouch& touch, RegionSlot& slot);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
