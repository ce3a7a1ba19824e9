// Contacts of two soft bodies, or of one with itself, as btSoftRigidDynamicsWorld wants them: of nodes with faces.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

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
    btScalar distance = 0;  ///< margins of both, m
};

/// Appends to btSoftBody::m_scontacts of the node's body; of two edges, both ends of the first against a face at the
/// second. Contacts are in world coordinates. Returns how many were written.
int writeSoftContact(const SoftContactSite& site, const SoftSurfaceContact& contact);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
