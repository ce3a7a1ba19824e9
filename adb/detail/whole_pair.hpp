// How near two whole bodies are, from the distributions of their surfaces alone: what can be said before the first
// step.
#pragma once

#include <grapeshot/adb/detail/pair_pose.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// Of two whole surfaces.
struct WholePair {
    float squaredDistance;  ///< D^2 (see surface_pair.hpp). NaN where single precision cannot tell: both are that thin
    /// By how many octaves the rates of all pairs below are raised: 0.5 (L - 9), within +-8. Bodies with little surface
    /// for their size meet less often than the rates of their parts say; by leave-one-mesh-out on the meshes for
    /// fitting, the tables lose 5 to 6 % less with it.
    float octaves;
};
/// About as long as `prepare` takes; the same bytes everywhere.
[[nodiscard]] WholePair wholePair(const WholeSurface& a, const WholeSurface& b, const PairPose& pose) noexcept;

/// Nearer than this, one body may lie inside the other, and no estimate says yes: nested shells look like a collision
/// to any sum of distributions, until the steps are as small as the gap. A shell inside one of its own shape cannot
/// come out of this zone before it touches, as long as the gap is small against the size.
inline constexpr float leastEstimated = 0.1F;

}  // namespace grapeshot::detail
