// Where a surface is, for one query or one step.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/scf/stretch.hpp>

namespace grapeshot {

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
};

/// A body that moves as a whole.
[[nodiscard]] inline SurfaceState rigidState(const Pose& pose = {}) {
    return {{}, pose, Stretch::rigid(), {}};
}

}  // namespace grapeshot
