// The second phase of a dispatch: all prepared pairs, within the frame's budget, on as many threads as wanted.
#pragma once

#include <memory>
#include <span>

#include <grapeshot/plugin/detail/frame.hpp>
#include <grapeshot/plugin/detail/pair_processor.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// First what cannot be cut short, then every other pair with its mandatory slice and its part of what it needed last
/// time; what that leaves is dealt out among those that were cut short, in up to three more rounds. Which pair gets
/// what depends on counts of work alone, unless the budget has a time.
///
/// Trees in `building` go on with a quarter of the dispatch's share, and with what the pairs leave of the rest; the
/// first of them to its end, then the next.
void computeFrame(std::span<PairProcessor* const> pairs, std::span<const std::shared_ptr<ShapeEntry>> building,
                  Frame& frame, const Settings& settings);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
