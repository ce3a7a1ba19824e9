// The only place where Bullet's vectors become Eigen's and back.
#pragma once

#include <LinearMath/btTransform.h>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

inline Eigen::Vector3f toEigen(const btVector3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

inline btVector3 toBullet(const Eigen::Vector3f& v) {
    return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

inline Eigen::Matrix3f toEigen(const btMatrix3x3& m) {
    Eigen::Matrix3f result;
    for (int row = 0; row < 3; ++row) {
        result.row(row) = toEigen(m[row]).transpose();
    }
    return result;
}

inline Pose toPose(const btTransform& transform) {
    return {toEigen(transform.getBasis()), toEigen(transform.getOrigin())};
}

/// B in A's frame, formed in btScalar and only then narrowed: far from the origin a double-precision world keeps its
/// precision.
inline btTransform relative(const btTransform& a, const btTransform& b) {
    return a.inverseTimes(b);
}

inline bool isFinite(const btVector3& v) {
    // Also false for values beyond single precision.
    return toEigen(v).allFinite();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
