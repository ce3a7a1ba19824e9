// The memory of a tracker as bytes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <grapeshot/scf/detail/tracker_state.hpp>

namespace grapeshot::detail {

/// What is tracked: two bodies, of the same mesh perhaps, or one with itself.
struct TrackedTrees {
    const BallTree& a;
    const BallTree& b;
    bool oneBody = false;
};

[[nodiscard]] std::vector<std::byte> savedMemory(const TrackerMemory& memory, const TrackedTrees& trees);

/// @throws Error badFile, topologyChanged
[[nodiscard]] TrackerMemory loadedMemory(std::span<const std::byte> bytes, const TrackedTrees& trees);

}  // namespace grapeshot::detail
