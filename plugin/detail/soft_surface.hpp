// The surface of a soft body as triangles: its faces, or the boundary of its tetrahedra, or its links.
//
// Bullet moves nodes and faces in memory when a body is refined or cut. So everything here is by index, and every look
// compares the body with what was read.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <grapeshot/plugin/detail/feature_owners.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// What was read of a body at one time. Never changes.
struct SoftSurface {
    BallTree tree;
    FeatureOwners owners;
    /// Of a rope: triangles of two nodes and the middle of their link, a vertex beyond the nodes.
    bool thread = false;
    bool solid = false;       ///< the boundary of tetrahedra: closed, normals outward
    std::uint32_t nodes = 0;  ///< vertices beyond are middles, of the two corners before them
    float meanEdge = 0;       ///< m, at the time it was read

    [[nodiscard]] const std::vector<Triangle>& triangles() const { return tree.surface.triangles; }
};

enum class NodePart {
    before,  ///< at the begin of the step
    after,   ///< predicted
};

/// Positions of all vertices in a frame, of a body of btSoftRigidDynamicsWorld during a dispatch. False if one is no
/// number.
[[nodiscard]] bool positionsOf(const btSoftBody& body, const SoftSurface& surface, NodePart part,
                               const btTransform& frame, std::vector<Eigen::Vector3f>& positions);
/// Both, each in its frame, in one pass over the nodes: of a fine body most of the time is reading them.
[[nodiscard]] bool positionsOf(const btSoftBody& body, const SoftSurface& surface, const btTransform& frameBefore,
                               const btTransform& frameAfter, std::vector<Eigen::Vector3f>& before,
                               std::vector<Eigen::Vector3f>& after);
/// Of any vertex from one array to the other, of the same size, m.
[[nodiscard]] float longestWay(std::span<const Eigen::Vector3f> from, std::span<const Eigen::Vector3f> to);
/// Of a body of btDeformableMultiBodyDynamicsWorld: as far as its velocities carry it in so many seconds.
[[nodiscard]] bool deformedPositionsOf(const btSoftBody& body, const SoftSurface& surface, btScalar seconds,
                                       const btTransform& frame, std::vector<Eigen::Vector3f>& positions);

/// What is known of the body at one address.
class SoftEntry {
  public:
    /// Its surface now; null if it has none that can be used, see `error`. Once per `look` (0: always, and all of it)
    /// the body is compared with what was read: the numbers of its elements, and the indices of 4,096 of them in turn.
    /// So what Bullet does (refine, cut, append) is seen at once, and an index that somebody has changed in a larger
    /// body some looks later. Building anew is some 5 us a triangle.
    std::shared_ptr<const SoftSurface> surface(const btSoftBody& body, std::uint64_t look);
    [[nodiscard]] const std::string& error() const { return m_error; }
    /// A face of Bullet's with the nodes of a triangle, for contacts of this step: the body's own, or one in its stead
    /// where its triangles are no faces.
    btSoftBody::Face& face(btSoftBody& body, std::uint32_t triangle);

  private:
    /// Is the body made of other elements than the last time?
    bool isChanged(const btSoftBody& body, bool thoroughly);
    std::shared_ptr<const SoftSurface> build(const btSoftBody& body);

    std::shared_ptr<const SoftSurface> m_surface;
    std::string m_error;
    std::vector<btSoftBody::Face> m_faces;
    std::vector<int> m_elements;  // node indices of tetrahedra, faces, links
    std::array<int, 4> m_sizes{-1, -1, -1, -1};
    std::size_t m_compared = 0;  // of the elements, in this round
    const void* m_place = nullptr;
    std::uint64_t m_look = 0;
};

/// Entries of one dispatcher's bodies, as long as somebody holds them.
class SoftEntries {
  public:
    std::shared_ptr<SoftEntry> entry(const btSoftBody& body);

  private:
    std::unordered_map<const btSoftBody*, std::weak_ptr<SoftEntry>> m_entries;  // looked up, never walked in its order
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
