// Where the nodes of a soft body have to go so that all contacts with one rigid body are kept: one motion per node.
//
// Bullet's contact of a node is solved both ways: of two at one node each undoes the other. So the contacts of a pair
// are brought together here, one-sided, and each node gets one.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/plugin/detail/surface_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct NodeMove {
    std::uint32_t node = 0;
    Eigen::Vector3d move = Eigen::Vector3d::Zero();  ///< from the predicted place, m, in the frame of the contacts
};

/// How far contacts bring nodes.
struct MoveSettings {
    double distance = 0;  ///< margins of both, m: what starts outside of it comes to it and no further
    double hardness = 1;  ///< 0..1, of what starts inside: share of the way back to the margin in one step
    bool thread = false;
};

/// Ascending by node; nodes that cannot or need not move are left out. By projected Gauss-Seidel: O(contacts).
[[nodiscard]] std::vector<NodeMove> nodeMoves(const btSoftBody& body, std::span<const SurfaceContact> contacts,
                                              const MoveSettings& settings);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
