// How many of the true regions of contact a method reports, by the age of the region.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stochastic_methods.hpp"
#include "stochastic_scenes.hpp"

namespace grapeshot::bench {

inline constexpr int mostAge = 16;      ///< the table of the paper ends there
inline constexpr int stepsBefore = 10;  ///< a method sees the bodies so long before they first touch
inline constexpr int stepsAfter = 24;

/// Regions by age; a region counts once in each step in which it exists.
struct Recall {
    std::array<std::size_t, mostAge + 1> regions{};  ///< [1..mostAge]
    std::array<std::size_t, mostAge + 1> found{};    ///< a reported pair lies in it, in this very step
    std::size_t reported = 0;
    std::size_t outside = 0;  ///< reported pairs that are farther apart than the distance in truth
    std::size_t steps = 0;
    double featureDistances = 0, trianglePairs = 0, boxTests = 0, activePairs = 0, regionsProposed = 0;  ///< sums
    double timeUs = 0;                                                                                   ///< sum

    void add(const Recall& other);
    [[nodiscard]] double share(int age) const;  ///< NaN if there was no such region
    /// The first age from which on at least that share is found; mostAge + 1: none.
    [[nodiscard]] int stepsTo(double wanted) const;
};

/// Per method, over `episodes` of a scene in which the bodies meet. @throws Error as the reference does
[[nodiscard]] std::vector<Recall> measureRecall(const ApproachScene& scene,
                                                const std::vector<StochasticMethod>& methods, int episodes,
                                                std::uint64_t seed);

}  // namespace grapeshot::bench
