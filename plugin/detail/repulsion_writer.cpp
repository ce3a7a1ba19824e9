#include <grapeshot/plugin/detail/repulsion_writer.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

void write(const NodeFace& pair, btScalar inside) {
    btSoftBody::DeformableFaceNodeContact contact;
    contact.m_node = pair.node;
    contact.m_face = pair.face;
    contact.m_bary = pair.weights;
    contact.m_normal = pair.normal;
    contact.m_margin = pair.gap() + btMax(inside, btScalar(0));
    contact.m_friction = pair.own->m_cfg.kDF * pair.other->m_cfg.kDF;
    contact.m_weights.setZero();
    contact.m_imf = 0;
    contact.m_c0 = 0;
    contact.m_colObj = pair.other;
    pair.own->m_faceNodeContacts.push_back(contact);
}

}  // namespace

int writeRepulsion(const NodeFace& pair, btSoftBody::Face& atNode, btScalar inside) {
    if (pair.node->m_im > 0) {
        write(pair, inside);
        return 1;
    }
    // Bullet takes the node's mass for that of both sides, and does nothing for one without. So each node of the face
    // meets the fixed one, as a corner of its own face.
    NodeFace turned{pair.other, pair.own, nullptr, &atNode};
    for (int k = 0; k < 3; ++k) {
        turned.weights[k] = atNode.m_n[k] == pair.node ? btScalar(1) : btScalar(0);
    }
    turned.normal = -pair.normal;
    int written = 0;
    for (int k = 0; k < 3; ++k) {
        turned.node = pair.face->m_n[k];
        if (turned.node->m_im > 0 && pair.weights[k] > btScalar(0.2) && turned.weights.length2() > 0) {
            write(turned, inside);
            ++written;
        }
    }
    return written;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
