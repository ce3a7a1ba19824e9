// How much it matters that a pair is looked at in this step, for the schedule of a frame.
#pragma once

#include <cstdint>
#include <span>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// What a pair can be judged by before anything is computed.
struct PairTraits {
    float motion = 0;             ///< what the two may approach by in the step, in contact breaking thresholds
    float mass = 0;               ///< that must be stopped if they meet: m1 m2 / (m1 + m2), kg; 0: nothing moves
    float size = 0;               ///< as PairSize::size, m
    std::uint32_t staleness = 0;  ///< steps since it was last looked at to the end
    bool uncertain = true;        ///< it was cut short last time, or is new
    float weight = 1;             ///< the program's own; not > 0 and finite: 1
};

/// Importance of each, positive and finite: a product of weight, motion (1..9), mass and size (each 1/4..4, relative to
/// the mean of all), staleness (1..3) and uncertainty (1 or 2).
void importanceOf(std::span<const PairTraits> pairs, std::span<float> importance);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
