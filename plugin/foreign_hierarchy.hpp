// The hierarchies that Bullet has built over its mesh shapes already, for `augment`.
//
// Triangles are numbered as everywhere in this room: those of part 0 in the order of its index array, then those of
// part 1 and so on, whatever the scale. A mirroring scale swaps corners within a triangle, not triangles.
#pragma once

#include <grapeshot/adb/augment.hpp>
#include <grapeshot/plugin/precision.hpp>

class btBvhTriangleMeshShape;
class btGImpactMeshShape;
class btGImpactMeshShapePart;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// From its btOptimizedBvh, quantised or not; scaling and refits of Bullet do not matter. For a scaled shape take its
/// child: the numbers are the same. O(n)
/// @throws Error emptyMesh (no hierarchy: it was made with buildBvh = false), indexOutOfRange (other parts or counts of
/// triangles than when the hierarchy was built, or more than Bullet can number: 1024 parts, 2^21 triangles in one),
/// badHierarchy (cut off), and as reading the mesh does: emptyMesh, badSetting
[[nodiscard]] ForeignHierarchy hierarchyOf(const btBvhTriangleMeshShape& shape);

/// From its box set, which is there after the first updateBound(). The number of a triangle is that within the part.
/// O(n)
/// @throws Error emptyMesh (no box set), badHierarchy, and as reading the mesh does
[[nodiscard]] ForeignHierarchy hierarchyOf(const btGImpactMeshShapePart& shape);

/// From the box sets of its parts, joined in twos in their order. O(n)
/// @throws Error as for a part, emptyMesh (no parts)
[[nodiscard]] ForeignHierarchy hierarchyOf(const btGImpactMeshShape& shape);

/// The tree over the shape's scaled triangles and Bullet's own hierarchy. O(n), see `augment` for meshes; not called by
/// the plugin itself, whose trees are built anew (they are better). Unlike all that is called by Bullet, it throws.
/// @throws Error as reading the mesh, `hierarchyOf` and `augment` do
[[nodiscard]] Tree augment(const btBvhTriangleMeshShape& shape);
[[nodiscard]] Tree augment(const btGImpactMeshShapePart& shape);
[[nodiscard]] Tree augment(const btGImpactMeshShape& shape);

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
