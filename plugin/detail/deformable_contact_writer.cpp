#include <grapeshot/plugin/detail/deformable_contact_writer.hpp>

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btSoftBodyInternals.h>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Fills what depends on the rigid side alone. @param inverseMass of the soft side
void fillRigidSide(const RigidContactSite& site, const btVector3& point, const btMatrix3x3& inverseMass,
                   btSoftBody::DeformableRigidContact& contact) {
    const btVector3 normal = contact.m_cti.m_normal;
    contact.m_cti.m_colObj = &site.rigid;
    contact.m_c1 = point - site.rigid.getWorldTransform().getOrigin();
    contact.m_c3 = site.soft.m_cfg.kDF * site.rigid.getFriction();
    contact.m_c4 = site.rigid.isStaticOrKinematicObject() ? site.soft.m_cfg.kKHR : site.soft.m_cfg.kCHR;
    contact.m_c5 = inverseMass;
    const auto* link = btMultiBodyLinkCollider::upcast(&site.rigid);
    if (link == nullptr || link->m_multiBody == nullptr) {
        static const btMatrix3x3 none(0, 0, 0, 0, 0, 0, 0, 0, 0);
        const btRigidBody* body = btRigidBody::upcast(&site.rigid);
        contact.m_c0 = ImpulseMatrix(btScalar(1), inverseMass, body != nullptr ? body->getInvMass() : btScalar(0),
                                     body != nullptr ? body->getInvInertiaTensorWorld() : none, contact.m_c1);
        return;
    }
    contact.t1 = generateUnitOrthogonalVector(normal);
    contact.t2 = btCross(normal, contact.t1);
    findJacobian(link, contact.jacobianData_normal, point, normal);
    findJacobian(link, contact.jacobianData_t1, point, contact.t1);
    findJacobian(link, contact.jacobianData_t2, point, contact.t2);
    const btMatrix3x3 rotation(normal.x(), normal.y(), normal.z(), contact.t1.x(), contact.t1.y(), contact.t1.z(),
                               contact.t2.x(), contact.t2.y(), contact.t2.z());
    const btMatrix3x3 ofLink = OuterProduct(
        &contact.jacobianData_normal.m_jacobians[0], &contact.jacobianData_t1.m_jacobians[0],
        &contact.jacobianData_t2.m_jacobians[0], &contact.jacobianData_normal.m_deltaVelocitiesUnitImpulse[0],
        &contact.jacobianData_t1.m_deltaVelocitiesUnitImpulse[0],
        &contact.jacobianData_t2.m_deltaVelocitiesUnitImpulse[0], link->m_multiBody->getNumDofs() + 6);
    contact.m_c0 = rotation.transpose() * (inverseMass + ofLink).inverse() * rotation;
}

bool canMove(const RigidContactSite& site) {
    const btRigidBody* body = btRigidBody::upcast(&site.rigid);
    return body != nullptr && body->getInvMass() > 0;
}

}  // namespace

bool writeDeformableContact(const RigidContactSite& site, SoftEntry& entry, const SoftSurfaceContact& contact,
                            float distance) {
    btSoftBody& soft = site.soft;
    const btVector3 normal = site.frame.getBasis() * toBullet(contact.normal);
    const auto gap = btScalar(contact.before - distance);
    if (contact.features == Features::cornerFace) {
        btSoftBody::Node& node = soft.m_nodes[static_cast<int>(contact.a[0])];
        if (node.m_battach || !(node.m_im > 0 || canMove(site))) {
            return false;
        }
        btSoftBody::DeformableNodeRigidContact written;
        written.m_cti.m_normal = normal;
        written.m_cti.m_offset = gap;
        written.m_cti.m_bary = btVector3(0, 0, 0);
        written.m_node = &node;
        written.m_c2 = node.m_im;
        fillRigidSide(site, node.m_x, node.m_effectiveMass_inv, written);
        soft.m_nodeRigidContacts.push_back(written);
        return true;
    }
    btSoftBody::Face& f = entry.face(soft, contact.pair.triangleA);
    btVector3 weights(0, 0, 0);
    btVector3 point(0, 0, 0);
    for (int i = 0; i < 3; ++i) {
        const btSoftBody::Node& node = soft.m_nodes[static_cast<int>(contact.a[static_cast<std::size_t>(i)])];
        for (int k = 0; k < 3; ++k) {
            weights[k] += f.m_n[k] == &node ? btScalar(contact.weightsA[i]) : btScalar(0);
        }
        point += btScalar(contact.weightsA[i]) * node.m_x;
    }
    btSoftBody::DeformableFaceRigidContact written;
    written.m_cti.m_normal = normal;
    written.m_cti.m_offset = gap;
    written.m_cti.m_bary = weights;
    written.m_face = &f;
    written.m_contactPoint = point;
    written.m_bary = weights;
    written.m_weights = btScalar(2) / (btScalar(1) + weights.length2()) * weights;
    btScalar inverse = 0;
    for (int k = 0; k < 3; ++k) {
        inverse += weights[k] * written.m_weights[k] * f.m_n[k]->m_im;
    }
    if (!(inverse > 0 || canMove(site))) {
        return false;
    }
    written.m_c2 = inverse;
    fillRigidSide(site, point, Diagonal(inverse), written);
    soft.m_faceRigidContacts.push_back(written);
    f.m_pcontact[3] = 0;
    return true;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
