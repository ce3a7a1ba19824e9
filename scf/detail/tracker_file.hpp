// The memory of a tracker as bytes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <grapeshot/scf/detail/tracker_state.hpp>

namespace grapeshot::detail {

[[nodiscard]] std::vector<std::byte> savedMemory(const TrackerMemory& memory, const BallTree& a, const BallTree& b);

/// @throws Error badFile, topologyChanged
[[nodiscard]] TrackerMemory loadedMemory(std::span<const std::byte> bytes, const BallTree& a, const BallTree& b);

}  // namespace grapeshot::detail
