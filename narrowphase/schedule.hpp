// How the work budget of a frame is split over its pairs.
//
// This work is based on:
// Victor D'Hondt. Systeme pratique et raisonne de representation proportionnelle. 1882 (a budget is dealt out one
// portion after the other, so a larger one begins with the same deals as a smaller one: nobody ever gets less of more)
#pragma once

#include <cstdint>
#include <span>

#include <grapeshot/core/budget.hpp>

namespace grapeshot {

/// Work units that every pair gets, whatever the budget: contacts are refreshed (which costs none), the triangles
/// around the deepest of them tested again, and a search goes on a little. About 2 us.
inline constexpr std::uint64_t mandatorySlice = 8;
/// The same for a pair that has no contacts or was cut short in the last step: a third of it may go into a stand-in,
/// the rest finds a contact where two surfaces first touch in nine cases of ten.
inline constexpr std::uint64_t searchSlice = 24;

/// The same by scf, which needs up to 17 units to look into two leaves.
inline constexpr std::uint64_t featureSlice = 96;

/// What is left beyond the mandatory slices is dealt out in portions of so many work units.
inline constexpr std::uint64_t slicePortion = 8;

/// A pair that wants to work in this frame.
struct ScheduledPair {
    std::uint64_t key = 0;  ///< its name; breaks ties, so no two should have the same
    /// Relative to the others: held within 1e-6..1e6; no number counts as the least.
    float importance = 1;
    /// Steps in a row in which it was cut short and got nothing beyond its mandatory slice.
    std::uint32_t age = 0;
    std::uint64_t mandatory = mandatorySlice;  ///< work units
    /// More than this is of no use to it (rounded up to whole portions), work units. Less than `mandatory` counts as
    /// `mandatory`.
    std::uint64_t wanted = unlimited;
};

/// What a pair's share of the rest goes by: importance, as held, times (1 + age). Positive and finite.
[[nodiscard]] double weightOf(const ScheduledPair& pair) noexcept;

struct ScheduleSums {
    std::uint64_t mandatory = 0;  ///< sum of the mandatory slices
    std::uint64_t slices = 0;     ///< sum of all slices; `unlimited` if one of them is
};

/// Fills `slices` (as many as pairs), in work units. A pure function:
/// - every pair gets its mandatory slice, and no more than `wanted`;
/// - the sum is at most max(budget, sum of the mandatory slices);
/// - of a larger budget no pair gets less; with `unlimited` each gets `unlimited`;
/// - the rest goes by weightOf, in proportion up to a portion. So a pair waits for at most about (number
///   of pairs) * (largest importance / its own) steps for work beyond its slice, if there is any;
/// - which pair gets what does not depend on the order of `pairs`.
/// O(n log n), whatever the budget.
ScheduleSums schedule(std::span<const ScheduledPair> pairs, std::uint64_t budget, std::span<std::uint64_t> slices);

}  // namespace grapeshot
