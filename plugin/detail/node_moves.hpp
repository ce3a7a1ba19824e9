// Where the nodes of soft bodies have to go so that all contacts of a pair are kept: one motion per node.
//
// Bullet's contact of a node is solved both ways: of two at one node each undoes the other. So the contacts of a pair
// are brought together here, one-sided, and each node gets one.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/plugin/detail/surface_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct NodeMove {
    std::uint32_t node = 0;
    Eigen::Vector3d move = Eigen::Vector3d::Zero();  ///< m, in the frame of the contacts
};

/// Whose nodes may move.
struct MovableBodies {
    const btSoftBody* a = nullptr;
    const btSoftBody* b = nullptr;  ///< null: it is rigid; the same as a: a body with itself
    bool threadA = false, threadB = false;
};

/// Of a and of b, each ascending by node; of a body with itself all in the first.
using NodeMoves = std::array<std::vector<NodeMove>, 2>;

/// The moves that bring every contact as far apart as it is to be. @param missing per contact, m; at most 0: nothing.
/// Nodes with infinite mass or an anchor stay. By projected Gauss-Seidel: O(contacts).
[[nodiscard]] NodeMoves nodeMoves(const MovableBodies& bodies, std::span<const SoftSurfaceContact> contacts,
                                  std::span<const double> missing);
/// Null if it does not move.
[[nodiscard]] const NodeMove* moveOf(std::span<const NodeMove> moves, std::uint32_t node);

/// How far a contact that starts inside of the margin is to come back in one step, m. The outer half of the margin is a
/// cushion as soft as the body's hardness (0..1) wants it, what is deeper comes back faster.
[[nodiscard]] double wayBack(double before, double distance, double hardness);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
