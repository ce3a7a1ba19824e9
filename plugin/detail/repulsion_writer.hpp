// Contacts of two soft bodies, or of one with itself, as btDeformableMultiBodyDynamicsWorld wants them.
#pragma once

#include <grapeshot/plugin/detail/node_face.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Appends to btSoftBody::m_faceNodeContacts of the node's body, where the world's applyRepulsionForce finds them after
/// its solver: what approaches is stopped, what is inside of the margin pushed out by btSoftBody's repulsion stiffness.
/// Returns how many were written: of a node that cannot move and a face that can, one for each node of the face.
/// @param atNode a face of the node's body that has the node
/// @param inside how far they are inside of the margins, m; at most 0: not yet
int writeRepulsion(const NodeFace& pair, btSoftBody::Face& atNode, btScalar inside);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
