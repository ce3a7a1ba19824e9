// One of the sixteen pairs of triangles of a call: how it gets there, and its normal.
#pragma once

#include <Eigen/Core>

#include <grapeshot/core/triangle_batch.hpp>
#include <grapeshot/scf/detail/ball_kernels.hpp>

namespace grapeshot::detail {

inline void copyLane(const PosedLeaf& from, unsigned lane, TriangleBatch& to, int toLane) {
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            to.corner[corner][axis][toLane] = from.corner[corner][axis][lane];
        }
    }
}

/// Unit, on B pointing to A along the closest points; B's own if they overlap or are no distance apart; of a B without
/// area, up.
/// @param out what `signedDistances` says of the pairs
[[nodiscard]] inline Eigen::Vector3f normalOf(const DistanceBatch& out, const TriangleBatch& b, int lane) {
    const Eigen::Vector3f gap(out.onA[0][lane] - out.onB[0][lane], out.onA[1][lane] - out.onB[1][lane],
                              out.onA[2][lane] - out.onB[2][lane]);
    const float length = gap.norm();
    if ((out.overlapping >> static_cast<unsigned>(lane) & 1U) == 0U && length > 1e-12F) {
        return gap / length;
    }
    const auto corner = [&](int i) {
        return Eigen::Vector3f(b.corner[i][0][lane], b.corner[i][1][lane], b.corner[i][2][lane]);
    };
    const Eigen::Vector3f u = corner(1) - corner(0);
    const Eigen::Vector3f v = corner(2) - corner(0);
    const Eigen::Vector3f n(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    const float area = n.norm();
    return area > 0 ? Eigen::Vector3f(n / area) : Eigen::Vector3f::UnitY();
}

}  // namespace grapeshot::detail
