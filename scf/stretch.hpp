// By how much do the edges of a surface stretch?
#pragma once

#include <Eigen/Core>
#include <span>

#include <grapeshot/scf/surface.hpp>

namespace grapeshot {

/// What bounds the stretch of the edges: length now / length at rest.
struct Stretch {
    enum class Source {
        given,     ///< `bound` is known, from the solver, say. Nothing is looked at; if it is exceeded, contacts may be
                   ///< missed and certain answers are as true as the bound
        measured,  ///< by one pass over all edges in every step; `bound` is the largest with which balls are used
        refitted,  ///< balls are fitted to the vertices in every step, bottom-up
    };
    Source source = Source::measured;
    /// Factor, at least 1 unless `refitted`. A measured stretch beyond it has the balls refitted for the step.
    float bound = 2;

    [[nodiscard]] static Stretch given(float bound) { return {Source::given, bound}; }
    [[nodiscard]] static Stretch measured(float limit = 2) { return {Source::measured, limit}; }
    [[nodiscard]] static Stretch refitted() { return {Source::refitted, 1}; }
    /// A body that moves as a whole.
    [[nodiscard]] static Stretch rigid() { return given(1); }
};

/// Largest length / length at rest over all edges; edges shorter than at rest count. Infinite if an edge without length
/// at rest has one; NaN if a position is not finite. One streaming pass, some 2 ns an edge.
/// @param positions as many as the surface has vertices; asserted
[[nodiscard]] float measureStretch(const Surface& surface, std::span<const Eigen::Vector3f> positions) noexcept;

}  // namespace grapeshot
