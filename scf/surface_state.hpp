// Where a surface is, for one query or one step.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/stretch.hpp>

namespace grapeshot {

/// What bounds how far any vertex has moved since the step before (of a `Tracker`: its last one that was not refused).
/// A surface without positions, which stays as it was at rest, needs none: what its pose does is known.
struct Displacement {
    enum class Source {
        unknown,   ///< nothing is concluded from the step before
        given,     ///< at most `bound`, in the common frame, pose included. Believed: if a vertex has gone farther,
                   ///< contacts may be missed and certain answers are as true as the bound
        measured,  ///< against a copy of the positions that the tracker keeps, 12 bytes a vertex, by one pass in every
                   ///< step; what the pose adds is bounded from the poses
    };
    Source source = Source::unknown;
    float bound = 0;  ///< m, >= 0

    [[nodiscard]] static Displacement given(float bound) { return {Source::given, bound}; }
    [[nodiscard]] static Displacement measured() { return {Source::measured, 0}; }
};

/// The spans are read during the call only.
struct SurfaceState {
    /// m, as many as vertices at rest; empty: at rest.
    std::span<const Eigen::Vector3f> positions;
    /// Applied to the positions, so that both surfaces are in one frame; rigid.
    std::optional<Pose> pose;
    Stretch stretch;
    /// The triangles that the caller has now; if given, they are compared with those the tree was built on (a hash of
    /// all, some gigabytes a second).
    std::span<const Triangle> triangles;
    /// For what a tracker may conclude from the step before; other queries have no use for it.
    Displacement displacement{};
};

/// A body that moves as a whole.
[[nodiscard]] inline SurfaceState rigidState(const Pose& pose = {}) {
    return {{}, pose, Stretch::rigid(), {}, {}};
}

}  // namespace grapeshot
