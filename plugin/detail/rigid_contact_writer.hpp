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

/// What a node may do beside the body.
struct NodeStop {
    std::uint32_t node = 0;
    Eigen::Vector3d normal;                           ///< unit, away from the body; frame of the contacts
    double approach = 0;                              ///< how much nearer it may come in the step, m, >= 0
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< where it will be then, frame of the contacts
};

/// Appends a contact to btSoftBody::m_rcontacts that stops the node there, together with the rigid body as their masses
/// are, and wakes the rigid body. False if neither can move, or the node is attached to something (m_battach): then
/// Bullet wants no contacts either.
bool writeRigidContact(const RigidContactSite& site, const NodeStop& stop);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
