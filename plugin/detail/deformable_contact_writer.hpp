// Contacts of a soft body with a rigid one, as btDeformableMultiBodyDynamicsWorld wants them: of nodes and of faces, in
// velocities; what is still apart is let come near.
#pragma once

#include <grapeshot/plugin/detail/rigid_contact_writer.hpp>
#include <grapeshot/plugin/detail/soft_surface.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Appends to btSoftBody::m_nodeRigidContacts or m_faceRigidContacts, for rigid bodies, links of multi-bodies and
/// objects without a mass. @param distance margins of both, m
bool writeDeformableContact(const RigidContactSite& site, SoftEntry& entry, const SoftSurfaceContact& contact,
                            float distance);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
