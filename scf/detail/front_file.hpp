// The front that a tracker remembers, as bytes.
#pragma once

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/detail/front_memory.hpp>
#include <grapeshot/scf/detail/tracker_file.hpp>

namespace grapeshot::detail {

void putFront(const FrontMemory& front, ByteWriter& out);

/// @throws Error badFile: numbers out of range, or records that are in no traversal of these trees
[[nodiscard]] FrontMemory frontFrom(ByteReader& in, const TrackedTrees& trees);

}  // namespace grapeshot::detail
