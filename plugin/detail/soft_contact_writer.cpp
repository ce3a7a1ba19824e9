#include <grapeshot/plugin/detail/soft_contact_writer.hpp>

#include <algorithm>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// One node beside a point of a face.
struct NodeFace {
    btSoftBody& own;
    btSoftBody& other;
    std::uint32_t node;
    btSoftBody::Face& face;
    std::array<std::uint32_t, 3> vertices;  ///< of the weights
    Eigen::Vector3f weights;
    btVector3 normal;  ///< to the node
    btScalar further;  ///< by how much it is to be further apart than predicted, m
    btScalar share;    ///< of that, 0..1
};

bool write(const NodeFace& pair) {
    btSoftBody::Node& node = pair.own.m_nodes[static_cast<int>(pair.node)];
    btVector3 weights(0, 0, 0);
    for (int i = 0; i < 3; ++i) {
        const btSoftBody::Node* vertex =
            &pair.other.m_nodes[static_cast<int>(pair.vertices[static_cast<std::size_t>(i)])];
        for (int k = 0; k < 3; ++k) {
            if (pair.face.m_n[k] == vertex) {
                weights[k] += btScalar(pair.weights[i]);
                break;
            }
        }
    }
    btScalar faceInverse = 0;
    btVector3 point(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
        faceInverse += weights[k] * pair.face.m_n[k]->m_im;
        point += weights[k] * pair.face.m_n[k]->m_x;
    }
    const btScalar sum = node.m_im + faceInverse;
    if (!(sum > 0)) {
        return false;
    }
    btSoftBody::SContact contact;
    contact.m_node = &node;
    contact.m_face = &pair.face;
    contact.m_weights = weights;
    contact.m_normal = pair.normal;
    contact.m_margin = btDot(pair.normal, node.m_x - point) + pair.further;
    contact.m_friction = btMax(pair.own.m_cfg.kDF, pair.other.m_cfg.kDF);
    // A face whose nodes move as their weights say moves at the point by the sum of their squares.
    const btScalar squares = btMax(weights.length2(), btScalar(0.2));
    contact.m_cfm[0] = pair.share * node.m_im / sum * pair.own.m_cfg.kSHR;
    contact.m_cfm[1] = pair.share * faceInverse / sum * pair.other.m_cfg.kSHR / squares;
    pair.own.m_scontacts.push_back(contact);
    return true;
}

}  // namespace

int writeSoftContact(const SoftContactSite& site, const SoftSurfaceContact& contact) {
    const btVector3 normal = toBullet(contact.normal);
    const btScalar further = btMin(site.distance, btScalar(contact.before)) - btScalar(contact.after);
    if (contact.features == Features::cornerFace) {
        return write({site.a, site.b, contact.a[0], site.entryB.face(site.b, contact.pair.triangleB), contact.b,
                      contact.weightsB, normal, further, 1})
                   ? 1
                   : 0;
    }
    if (contact.features == Features::faceCorner) {
        return write({site.b, site.a, contact.b[0], site.entryA.face(site.a, contact.pair.triangleA), contact.a,
                      contact.weightsA, -normal, further, 1})
                   ? 1
                   : 0;
    }
    int written = 0;
    btSoftBody::Face& face = site.entryB.face(site.b, contact.pair.triangleB);
    for (int i = 0; i < 2; ++i) {
        const auto share = btScalar(contact.weightsA[i]);
        written += share > btScalar(0.05) && write({site.a, site.b, contact.a[static_cast<std::size_t>(i)], face,
                                                    contact.b, contact.weightsB, normal, further, share})
                       ? 1
                       : 0;
    }
    return written;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
