// How far two surfaces may have come nearer to each other since the step before.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot::detail {

/// Where a surface was in the step before, as far as the next one needs it.
struct SurfaceBefore {
    bool isKnown = false;  ///< there was such a step
    bool atRest = false;   ///< it was told no positions
    std::optional<Pose> pose;
    float extent = 0;                        ///< m, largest distance of a vertex from the origin of its own frame
    std::vector<Eigen::Vector3f> positions;  ///< those of a step that measures, in their own frame
};

/// By how much a surface has changed its shape, in its own frame.
struct Deformation {
    float most = 0;    ///< m, no vertex has moved farther; infinite: not known, NaN: a position is not finite
    float extent = 0;  ///< m, now
};

/// One pass over the vertices if the displacement is measured; of a surface at rest, or whose bound is given, none.
/// @param restExtent m, of the surface at rest
[[nodiscard]] Deformation deformationSince(const SurfaceBefore& before, const SurfaceState& now, const Surface& surface,
                                           float restExtent);

/// Can the next step know how far it has moved?
[[nodiscard]] inline bool isTold(const SurfaceState& state) {
    return state.positions.empty() || state.displacement.source != Displacement::Source::unknown;
}

/// What `deformationSince` will ask for in the next step.
void remember(const SurfaceState& now, const Deformation& deformation, SurfaceBefore& out);

/// m, an upper bound on by how much a point of one surface has come nearer to one of the other; 0 only if no position
/// has changed by a bit, infinite if nothing is known. The motion of both together does not count, unless one of their
/// displacements is given.
[[nodiscard]] float nearerThanBefore(const SurfaceBefore& beforeA, const SurfaceState& a, const Deformation& ofA,
                                     const SurfaceBefore& beforeB, const SurfaceState& b, const Deformation& ofB);
/// Of a surface and itself.
[[nodiscard]] float nearerThanBefore(const SurfaceBefore& before, const Deformation& of);

}  // namespace grapeshot::detail
