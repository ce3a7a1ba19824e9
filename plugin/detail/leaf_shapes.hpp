// What Bullet's recursion into compound shapes ends in.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include <vector>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct PlacedShape {
    const btCollisionShape* shape = nullptr;
    btTransform inBody;  ///< the shape in the body's frame
};

/// Appends the shape itself, or the children of a compound and theirs. A GImpact compound is a leaf: its own algorithm
/// looks after its children. Compounds nested deeper than 64 (a shape that contains itself) end there.
void appendLeaves(const btCollisionShape& shape, const btTransform& inBody, std::vector<PlacedShape>& leaves);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
