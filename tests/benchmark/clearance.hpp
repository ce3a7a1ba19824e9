// The careful answer for the few poses on which two programs disagree.
#pragma once

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot::bench {

/// How far a pose is from the border between colliding and clear, m: the smallest distance of the surfaces (positive),
/// or minus the largest translation that parts a single overlapping pair of triangles. Distances beyond `reach` are
/// reported as `reach`. In double precision with long double signs, by the tests' oracle on all pairs whose boxes are
/// within reach: no hierarchy, no code of the library.
[[nodiscard]] double clearance(MeshView a, MeshView b, const Pose& bInA, double reach);

}  // namespace grapeshot::bench
