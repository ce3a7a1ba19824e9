// The triangle of a contact in place of its mesh, while Bullet tells the program of the contact.
//
// Material callbacks and queries get a wrapper for each body. Where Bullet tests a convex shape against a triangle, it
// is that of the triangle, with the mesh's as its parent; programs that look up materials, and
// btAdjustInternalEdgeContacts, count on it.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <array>

#include <grapeshot/plugin/detail/child_in_place.hpp>
#include <grapeshot/plugin/detail/shape_mesh.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// What a program may want to see of a mesh at a contact.
struct TriangleFace {
    const btCollisionObjectWrapper* mesh = nullptr;  ///< null: nobody asks, or it has no triangle of that name
    std::array<btVector3, 3> corner;                 ///< mesh's frame
};

/// For as long as it lives.
class TriangleInPlace {
  public:
    TriangleInPlace(const TriangleFace& face, const TriangleId& id, bool isFirst, btManifoldResult& result)
        : m_shape(face.corner[0], face.corner[1], face.corner[2]),
          m_wrap(face.mesh, &m_shape, face.mesh->getCollisionObject(), face.mesh->getWorldTransform(), id.part,
                 id.index),
          m_inPlace(result, m_wrap, isFirst) {
        m_shape.setMargin(face.mesh->getCollisionShape()->getMargin());
    }

  private:
    btTriangleShape m_shape;
    btCollisionObjectWrapper m_wrap;
    WrapInPlace m_inPlace;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
