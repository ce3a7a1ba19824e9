// How near two whole bodies are, from the distributions of their surfaces alone: what can be said before the first step.
#pragma once

#include <grapeshot/adb/detail/pair_pose.hpp>
#include <grapeshot/adb/tree.hpp>

namespace grapeshot::detail {

/// D^2 of two whole surfaces (see surface_pair.hpp). NaN if both are so thin, or their units so far apart, that single
/// precision cannot tell. About as long as `prepare` takes; the same bytes everywhere.
[[nodiscard]] float squaredDistanceOfWholes(const WholeSurface& a, const WholeSurface& b,
                                            const PairPose& pose) noexcept;

}  // namespace grapeshot::detail
