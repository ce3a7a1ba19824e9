// Contacts of two soft bodies, or of one with itself, as btSoftRigidDynamicsWorld wants them.
#pragma once

#include <grapeshot/plugin/detail/node_face.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Appends to btSoftBody::m_scontacts of the node's body. False if nothing can move.
/// @param further by how much both are to be further apart than predicted, m
bool writeSoftContact(const NodeFace& pair, btScalar further);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
