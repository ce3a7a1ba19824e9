// Where B is in A's frame, in double precision.
#pragma once

#include <Eigen/Core>

#include <grapeshot/core/pose.hpp>

namespace grapeshot::reference {

/// The rotation is taken as it comes: single precision leaves it orthonormal to 1e-7 only, and everything here must
/// hold for the linear map that it is, or pairs that touch would be called disjoint.
struct Placement {
    /// @throws Error notFinite, notRigid
    explicit Placement(const Pose& bInA);

    [[nodiscard]] Eigen::Vector3d toA(const Eigen::Vector3d& pointOfB) const {
        return rotation * pointOfB + translation;
    }

    Eigen::Matrix3d rotation;
    Eigen::Matrix3d inverseRotation;
    Eigen::Vector3d translation;
    double stretch;  ///< no vector becomes longer than this by the rotation; 1 but for rounding
};

}  // namespace grapeshot::reference
