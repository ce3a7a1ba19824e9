// Contacts of a soft body with a rigid one, as btSoftRigidDynamicsWorld wants them.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <grapeshot/plugin/detail/node_moves.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Where a soft body meets a rigid one, for one step.
struct RigidContactSite {
    btSoftBody& soft;
    const btCollisionObject& rigid;
    btTransform frame;  ///< of the contacts: the rigid shape's at the end of the step
    btVector3 origin;   ///< of the rigid body then
};

/// Appends a contact to btSoftBody::m_rcontacts that makes the node move so, together with the rigid body as their
/// masses are, and wakes the rigid body. False if neither can move, or the node is attached to something (m_battach):
/// then Bullet wants no contacts either.
bool writeRigidContact(const RigidContactSite& site, const NodeMove& move);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
