// What is kept of shapes between steps.
#pragma once

#include <cstdint>
#include <string>

#include <grapeshot/narrowphase/method.hpp>
#include <grapeshot/plugin/precision.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionShape;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Vertices or indices of a mesh were edited in place. Scale, margins, new arrays and other counts are noticed without
/// it; of edits in place, those that touch one of the 64 vertices or 16 triangles looked at in each step (other ones
/// each time). When the shape is met next its tree is refitted if it has the same triangles and a pair with it was
/// there all the while, else built anew.
void notifyChanged(const btCollisionShape* shape) noexcept;

/// Builds the tree of a mesh shape now (about 2 us per triangle) instead of when it first comes near another. Shapes
/// with the same content share one tree. At most 64 trees that nobody uses are kept.
/// @param method that the shape will be used with: for scf its ball tree is built, too (about 5 us per triangle more),
/// which else is built in slices as below, some 30 work units per triangle more
///
/// Without it: where a Dispatcher's budget is limited, trees are built in slices, about 12 work units per triangle out
/// of a quarter of each frame's budget and what the pairs leave of it, while a pair with the shape is there; 64 units a
/// frame whatever the budget. Until then 256 of its triangles, each three times as wide as its share of the surface,
/// stand in for it (about 4,000 units, once, beyond the budget if need be; up to 512 triangles: the tree itself); for
/// an edited shape, what it was before. Such pairs count as degraded. Everywhere else, at once. How soon it is there
/// depends on what the process has met before: for the same bytes in every run, call this.
Status prebuild(const btCollisionShape* shape, Method method = Method::automatic) noexcept;

/// Trees of all shapes of the process are kept in this folder too from now on, and read from it; one file is read or
/// written at once. It is made when needed; "" is nowhere, as in the beginning. A file that is of no use is ignored,
/// and counted.
Status keepTrees(const char* folder) noexcept;

/// Since the process began.
struct TreeCounts {
    std::uint64_t built = 0;     ///< models made
    std::uint64_t loaded = 0;    ///< of these, trees that came from the folder
    std::uint64_t badFiles = 0;  ///< that were ignored, or could not be written
    std::string lastWarning;     ///< of the last of these, in words
};
[[nodiscard]] TreeCounts treeCounts() noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
