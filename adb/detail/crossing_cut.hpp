// The cut through the tree of pairs that stands for the curve of two surfaces: refined where expected length times
// extent is largest.
#pragma once

#include <cstddef>
#include <cstdint>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/detail/descent.hpp>

namespace grapeshot::detail {

/// Sixteen entries of a cut side by side, those of one step: nothing is moved, and all is aligned. Plain data. (Columns
/// over the whole cut would have a stride of a power of two and fight for the same cache lines.)
struct alignas(64) CrossingBlock {
    float position[3][16];  ///< A's frame, m
    float direction[3][16];
    float length[16];    ///< m
    float extent[16];    ///< m
    float flatness[16];  ///< of both surfaces, multiplied
    float cosine[16];    ///< of the angle between both normals, times the flatness
    float rate[16];
    Side sidesA[16];
    Side sidesB[16];
};

inline constexpr std::size_t crossingBlocks = 64;
/// If more entries than this are left when the room is used up, the most urgent one is refined depth first, to its end.
inline constexpr std::size_t mostOfCrossing = 768;

/// Every pair of triangles that intersects lies below an entry, or was found. Entries without urgency are not there.
struct CrossingCut {
    alignas(64) float urgency[crossingBlocks][16];  ///< length times extent, but never 0
    CrossingBlock block[crossingBlocks];
    std::size_t count;  ///< of blocks
};

enum class CrossingEnd {
    exhausted,  ///< the cut is empty
    found,      ///< at Descent::found, off the cut: triangles of two leaves that intersect
    full,       ///< the most urgent entry is off the cut and on the descent's stack
    budget,
};

/// Only the root, to be taken up at no matter what it is worth.
void startCrossing(CrossingCut& cut) noexcept;

/// Refines, spending at most `units`.
CrossingEnd refineCrossing(Descent& descent, CrossingCut& cut, const RateFormula& formula,
                           std::uint64_t units) noexcept;

struct CrossingSummary {
    std::size_t worthTelling;  ///< so many entries
    float rate;                ///< sum over all entries
};
/// Writes the places (16 * block + lane) of the entries that are worth telling to `places`, which has room for all, in
/// ascending order: all entries, but for the shortest, which together have at most `leaveOut` of the expected length;
/// `proven` (m) of it has been found besides.
CrossingSummary summarise(const CrossingCut& cut, float proven, float leaveOut, std::uint32_t* places) noexcept;

}  // namespace grapeshot::detail
