#include <grapeshot/plugin/detail/soft_contact_writer.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

bool writeSoftContact(const NodeFace& pair, btScalar further) {
    const btScalar faceInverse = pair.faceInverseMass();
    const btScalar sum = pair.node->m_im + faceInverse;
    if (!(sum > 0)) {
        return false;
    }
    btSoftBody::SContact contact;
    contact.m_node = pair.node;
    contact.m_face = pair.face;
    contact.m_weights = pair.weights;
    contact.m_normal = pair.normal;
    contact.m_margin = pair.gap() + further;
    contact.m_friction = btMax(pair.own->m_cfg.kDF, pair.other->m_cfg.kDF);
    // A face whose nodes move as their weights say moves at the point by the sum of their squares.
    const btScalar squares = btMax(pair.weights.length2(), btScalar(0.2));
    contact.m_cfm[0] = pair.share * pair.node->m_im / sum * pair.own->m_cfg.kSHR;
    contact.m_cfm[1] = pair.share * faceInverse / sum * pair.other->m_cfg.kSHR / squares;
    pair.own->m_scontacts.push_back(contact);
    return true;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
