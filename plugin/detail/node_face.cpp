#include <grapeshot/plugin/detail/node_face.hpp>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Vertices = std::array<std::uint32_t, 3>;

btVector3 weightsOn(const btSoftBody::Face& face, btSoftBody& body, const Vertices& vertices,
                    const Eigen::Vector3f& weights) {
    btVector3 sorted(0, 0, 0);
    for (int i = 0; i < 3; ++i) {
        const btSoftBody::Node* vertex = &body.m_nodes[static_cast<int>(vertices[static_cast<std::size_t>(i)])];
        for (int k = 0; k < 3; ++k) {
            if (face.m_n[k] == vertex) {
                sorted[k] += btScalar(weights[i]);
                break;
            }
        }
    }
    return sorted;
}

}  // namespace

btScalar NodeFace::gap() const {
    btVector3 point(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
        point += weights[k] * face->m_n[k]->m_x;
    }
    return btDot(normal, node->m_x - point);
}

btScalar NodeFace::faceInverseMass() const {
    btScalar sum = 0;
    for (int k = 0; k < 3; ++k) {
        sum += weights[k] * face->m_n[k]->m_im;
    }
    return sum;
}

void appendNodeFaces(const SoftContactSite& site, const SoftSurfaceContact& contact, btScalar leastShare,
                     std::vector<NodeFace>& parts) {
    const btVector3 normal = toBullet(contact.normal);
    const bool cornerOfB = contact.features == Features::faceCorner;
    btSoftBody& own = cornerOfB ? site.b : site.a;
    btSoftBody& other = cornerOfB ? site.a : site.b;
    btSoftBody::Face& face =
        cornerOfB ? site.entryA.face(site.a, contact.pair.triangleA) : site.entryB.face(site.b, contact.pair.triangleB);
    const Vertices& corners = cornerOfB ? contact.b : contact.a;
    NodeFace part{&own, &other, nullptr, &face};
    part.weights = cornerOfB ? weightsOn(face, other, contact.a, contact.weightsA)
                             : weightsOn(face, other, contact.b, contact.weightsB);
    part.normal = cornerOfB ? -normal : normal;
    const bool edges = contact.features == Features::edges;
    for (int i = 0; i < (edges ? 2 : 1); ++i) {
        part.node = &own.m_nodes[static_cast<int>(corners[static_cast<std::size_t>(i)])];
        part.share = edges ? btScalar(contact.weightsA[i]) : btScalar(1);
        if (!edges || part.share > leastShare) {
            parts.push_back(part);
        }
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
