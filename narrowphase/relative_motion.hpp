// By how much two bodies have moved against each other: what decides whether something known of them still holds.
#pragma once

#include <Eigen/Core>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot {

/// How far any point of B (radius about its frame's origin) can have moved against A between two relative poses, m.
/// Rigorous.
[[nodiscard]] float motionBound(const Pose& before, const Pose& now, float radiusOfB);

/// The same for those points of B alone that are within `reach` of A's box now, and so can be within `reach` of A: a
/// body that rolls hardly moves where it touches. 0 if there are none. Rigorous.
[[nodiscard]] float nearMotionBound(const Tree& a, const Tree& b, const Pose& before, const Pose& now, float reach);

/// How far any point of A's box can have moved against B between two relative poses, m: for a B without end. Rigorous.
[[nodiscard]] float boxMotionBound(const Tree& a, const Pose& before, const Pose& now);

/// Has the distance of any two points of A and B that are within `reach` of each other now surely changed by no more
/// than `limit` (m) between two relative poses? By these bounds, of B's points against A and of A's against B, the
/// cheap ones first.
[[nodiscard]] bool movedAtMost(float limit, const Tree& a, const Tree& b, const Pose& before, const Pose& now,
                               float reach);

}  // namespace grapeshot
