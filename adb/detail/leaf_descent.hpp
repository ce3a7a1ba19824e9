// The descent to all leaf pairs near each other, without a budget.
#pragma once

#include <cstddef>
#include <cstdint>

#include <grapeshot/adb/detail/descent.hpp>

namespace grapeshot::detail {

/// What a descent found since it was called: indices of leaf blocks, pair by pair.
struct LeafPairBatch {
    static constexpr std::size_t capacity = 256;
    std::size_t count = 0;
    std::uint32_t leafA[capacity], leafB[capacity];
};

/// What the descent passed by, because it is too far off to be taken up but still near: boxes of nodes and leaves of
/// both trees, each in its frame, lane by lane.
struct alignas(64) PassedBy {
    float lower[2][3][16], upper[2][3][16];
    float threshold = 0;  ///< as PairPose::threshold, and no more than that
};

/// From the stack on until it is empty (DescentEnd::exhausted) or the batch is full (found): all leaf pairs whose boxes
/// touch, in the order of toLeafPair. Units as there.
DescentEnd toLeafPairs(Descent& descent, LeafPairBatch& batch, PassedBy& passed) noexcept;

}  // namespace grapeshot::detail
