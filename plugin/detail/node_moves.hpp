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

/// The moves that bring every contact as far apart as it is to be. @param missing per contact, m; at most 0: nothing.
/// Contacts that no node of the body can do anything about are left out (ropes: those of what stands for their faces).
/// Ascending by node. By projected Gauss-Seidel: O(contacts).
[[nodiscard]] std::vector<NodeMove> nodeMoves(const btSoftBody& body, std::span<const SurfaceContact> contacts,
                                              std::span<const double> missing, bool thread);

/// How far a contact that starts inside of the margin is to come back in one step, m. The outer half of the margin is a
/// cushion as soft as the body's hardness (0..1) wants it, what is deeper comes back faster.
[[nodiscard]] double wayBack(double before, double distance, double hardness);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
