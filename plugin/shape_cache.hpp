// What is kept of shapes between steps.
#pragma once

#include <grapeshot/plugin/status.hpp>

class btCollisionShape;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Vertices or indices of a mesh were edited in place. Scale, margins, new arrays and other counts are noticed without
/// it; of edits in place, those that touch one of the 64 vertices or 16 triangles looked at in each step (other ones
/// each time). With the same triangles, the tree is refitted, else built anew, when the shape is met next.
void notifyChanged(const btCollisionShape* shape) noexcept;

/// Builds the tree of a mesh shape now (about 2 us per triangle) instead of when it first comes near another. Shapes
/// with the same content share one tree. At most 64 trees that nobody uses are kept.
Status prebuild(const btCollisionShape* shape) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
