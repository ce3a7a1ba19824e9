// What is inside of a margin comes back by its place alone: a correction by its velocity would throw it out.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <vector>

#include <grapeshot/plugin/detail/node_moves.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct BringBack {
    MovableBodies bodies;
    double distance = 0;  ///< margins of both, m
    double hardness = 1;  ///< 0..1
    btMatrix3x3 frame;    ///< of the contacts
};

/// Moves nodes, where they were before the step and where they would go, by the same; and what is known of them: the
/// positions in the frame of the contacts (of b: null if it is rigid, or a itself), and the contacts' distances.
void bringBack(const BringBack& task, btSoftBody& a, btSoftBody* b, std::vector<Eigen::Vector3f>* beforeA,
               std::vector<Eigen::Vector3f>* beforeB, std::vector<SoftSurfaceContact>& contacts);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
