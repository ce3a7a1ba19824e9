// Centre of mass, principal axes and inertia of a mesh shape. Bullet gives moving btBvhTriangleMeshShapes an inertia of
// zero, and GImpact meshes that of point masses at the vertices.
#pragma once

#include <LinearMath/btTransform.h>

#include <grapeshot/plugin/status.hpp>

class btCollisionShape;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

enum class MassModel {
    automatic,  ///< solid if the mesh is closed and not inside out, else shell
    solid,      ///< even density inside; a mesh that is not closed is refused
    shell,      ///< even mass per area
};

struct MassProperties {
    /// ok; else all else is the default. badArgument: mass not > 0 and finite, or `solid` asked of an open mesh.
    Status status = Status::ok;
    bool solid = false;   ///< which model was taken
    btScalar volume = 0;  ///< m^3, 0 for shells
    btScalar area = 0;    ///< m^2
    /// Centre of mass and principal axes in the shape's frame: the frame that a btRigidBody wants to have as its own.
    /// Move the vertices by its inverse, or put the shape into a btCompoundShape with its inverse as child transform.
    /// The rotation is the identity where the shape's axes are principal already.
    btTransform principal = btTransform::getIdentity();
    btVector3 inertia{0, 0, 0};  ///< about the principal axes, kg m^2: localInertia of btRigidBody
};

/// For GImpact meshes and parts, BVH meshes and scaled BVH meshes, scale included, margin not. O(triangles).
[[nodiscard]] MassProperties massProperties(const btCollisionShape* shape, btScalar mass,
                                            MassModel model = MassModel::automatic) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
