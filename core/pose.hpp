// Where one rigid body is, seen from another.
#pragma once

#include <Eigen/Core>

namespace grapeshot {

/// B in A's frame: a point x of B is `rotation * x + translation` in A's frame. The rotation is orthonormal with
/// determinant +1. Only Vector3f and Matrix3f stand in public types: their alignment does not depend on the caller's
/// -march, so that the binary interface holds.
struct Pose {
    Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
    Eigen::Vector3f translation = Eigen::Vector3f::Zero();
};

[[nodiscard]] inline Eigen::Vector3f apply(const Pose& pose, const Eigen::Vector3f& point) {
    return pose.rotation * point + pose.translation;
}

/// A in B's frame, given B in A's.
[[nodiscard]] inline Pose inverse(const Pose& pose) {
    return {pose.rotation.transpose(), -(pose.rotation.transpose() * pose.translation)};
}

/// C in A's frame, given B in A's and C in B's.
[[nodiscard]] inline Pose compose(const Pose& bInA, const Pose& cInB) {
    return {bInA.rotation * cInB.rotation, bInA.rotation * cInB.translation + bInA.translation};
}

/// All twelve numbers finite, and the rotation orthonormal and right-handed within `tolerance` per entry of R^T R.
[[nodiscard]] bool isRigid(const Pose& pose, float tolerance = 1e-3F) noexcept;

}  // namespace grapeshot
