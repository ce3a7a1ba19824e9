// How near two whole bodies are, from the distributions of their surfaces alone: what can be said before the first
// step.
#pragma once

#include <grapeshot/adb/detail/pair_pose.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// D^2 (see surface_pair.hpp) of two whole surfaces. NaN where single precision cannot tell: both are that thin. About
/// as long as `prepare` takes; the same bytes everywhere.
[[nodiscard]] float squaredDistanceOfWholes(const WholeSurface& a, const WholeSurface& b,
                                            const PairPose& pose) noexcept;

/// Nearer than this, one body may lie inside the other, and no estimate says yes: nested shells look like a collision
/// to any sum of distributions, until the steps are as small as the gap. A shell inside one of its own shape cannot
/// come out of this zone before it touches, as long as the gap is small against the size.
inline constexpr float leastEstimated = 0.1F;

}  // namespace grapeshot::detail
