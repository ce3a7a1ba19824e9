// Contacts of two soft bodies, or of one with itself, in the words of Bullet's soft worlds: one node beside a point of
// a face.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <vector>

#include <grapeshot/plugin/detail/soft_surface.hpp>
#include <grapeshot/plugin/detail/surface_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct SoftContactSite {
    btSoftBody& a;
    btSoftBody& b;
    SoftEntry& entryA;
    SoftEntry& entryB;
};

struct NodeFace {
    btSoftBody* own = nullptr;  ///< the node's body
    btSoftBody* other = nullptr;
    btSoftBody::Node* node = nullptr;
    btSoftBody::Face* face = nullptr;
    btVector3 weights{0, 0, 0};  ///< of the face's nodes; their sum is 1
    btVector3 normal{0, 0, 0};   ///< unit, to the node, world
    btScalar share = 1;          ///< of the contact: 0..1

    /// Distance of node and point along the normal, as the nodes are now, m.
    [[nodiscard]] btScalar gap() const;
    /// Of the point, as Bullet weighs it: 1 / kg.
    [[nodiscard]] btScalar faceInverseMass() const;
};

/// Appends the contact: of two edges, both ends of the first against a face at the second, each with its share if that
/// is more than `leastShare`.
void appendNodeFaces(const SoftContactSite& site, const SoftSurfaceContact& contact, btScalar leastShare,
                     std::vector<NodeFace>& parts);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
