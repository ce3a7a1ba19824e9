#include <grapeshot/plugin/detail/rigid_contact_writer.hpp>

#include <BulletSoftBody/btSoftBodyInternals.h>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Depth of the contact's plane, m. Bullet takes away what is left of the relative motion and adds c4 times the depth
/// by then; from so far the sum is where the node is to be, however often that is done and wherever links have pulled
/// it.
constexpr btScalar bottomless = 1e6;

}  // namespace

bool writeRigidContact(const RigidContactSite& site, const NodeStop& stop) {
    btSoftBody& soft = site.soft;
    btSoftBody::Node& node = soft.m_nodes[static_cast<int>(stop.node)];
    auto* body = const_cast<btRigidBody*>(btRigidBody::upcast(&site.rigid));
    const btScalar rigidInverse = body != nullptr ? body->getInvMass() : btScalar(0);
    if (node.m_battach || !(node.m_im + rigidInverse > 0)) {
        return false;
    }
    const btVector3 normal = site.frame.getBasis() * toBullet(stop.normal.cast<float>());
    static const btMatrix3x3 none(0, 0, 0, 0, 0, 0, 0, 0, 0);
    const btScalar step = soft.m_sst.sdt;
    const btVector3 arm = site.frame * toBullet(stop.place.cast<float>()) - site.origin;
    const btVector3 way = body != nullptr ? body->getVelocityInLocalPoint(arm) * step : btVector3(0, 0, 0);
    const btVector3 relative = node.m_x - node.m_q - way;
    const btScalar along = btDot(relative, normal);
    const btVector3 across = relative - normal * along;
    const btScalar friction = soft.m_cfg.kDF * site.rigid.getFriction();
    btSoftBody::RContact contact;
    contact.m_cti.m_colObj = &site.rigid;
    contact.m_cti.m_normal = normal;
    contact.m_cti.m_offset = -bottomless - btDot(normal, node.m_x);
    contact.m_cti.m_bary = btVector3(0, 0, 0);
    contact.m_node = &node;
    contact.m_c0 =
        ImpulseMatrix(step, node.m_im, rigidInverse, body != nullptr ? body->getInvInertiaTensorWorld() : none, arm);
    contact.m_c1 = arm;
    contact.m_c2 = node.m_im * step;
    contact.m_c3 = across.length2() < along * friction * along * friction ? btScalar(0) : 1 - friction;
    contact.m_c4 = -btScalar(stop.approach) / bottomless;
    contact.t1 = contact.t2 = btVector3(0, 0, 0);  // of multi-bodies: made by the solver
    soft.m_rcontacts.push_back(contact);
    if (body != nullptr) {
        body->activate();
    }
    return true;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
