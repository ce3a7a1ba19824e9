// One place where two bodies touch or nearly touch: the currency of this room.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace grapeshot {

/// Everything in A's frame, metres, of the bare surfaces (margins are subtracted by the host).
struct SurfaceContact {
    Eigen::Vector3f onA = Eigen::Vector3f::Zero();
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();  ///< unit, on B pointing to A
    float signedDistance = 0;                           ///< negative: penetration. onA = onB + normal * signedDistance
    std::uint32_t triangleA = 0xffffffffU;              ///< index in A's mesh; all ones if A is no mesh
    std::uint32_t triangleB = 0xffffffffU;
};

}  // namespace grapeshot
