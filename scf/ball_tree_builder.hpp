// Building surfaces and ball trees in slices, for whoever may not stop for so long: see core/sliced.hpp.
#pragma once

#include <grapeshot/core/sliced.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {

/// As `makeSurface`, into an empty surface.
Sliced makeSurfaceInSlices(MeshView rest, Surface& surface);

/// Fills an empty `tree` as `buildBallTree` does, byte for byte, and throws what it throws. `rest` must stay as it is
/// until then. About 25 work units a triangle.
Sliced buildBallTreeInSlices(MeshView rest, BallTree& tree);

}  // namespace grapeshot
