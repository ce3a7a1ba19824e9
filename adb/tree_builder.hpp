// Building and moving trees in slices, for whoever may not stop for so long: see core/sliced.hpp.
#pragma once

#include <span>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/sliced.hpp>

namespace grapeshot {

/// Fills `tree` as `build` does, byte for byte, and throws what it throws. `mesh` is copied on the way: it must stay as
/// it is until then. 4 work units a triangle and some; tuning is paid for with 8 a pose and then done in one piece,
/// which takes about 1 us a pose: whoever may not stop sets BuildSettings::tuningPoses to 0.
Sliced buildInSlices(MeshView mesh, BuildSettings settings, Tree& tree);

/// As `refit`. Until it is done, or if it throws after the vertices were looked at, the tree is of no use.
Sliced refitInSlices(Tree& tree, std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot
