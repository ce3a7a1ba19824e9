#include <grapeshot/core/pose.hpp>

#include <Eigen/LU>
#include <cmath>

namespace grapeshot {

bool isRigid(const Pose& pose, float tolerance) noexcept {
    if (!pose.rotation.allFinite() || !pose.translation.allFinite()) {
        return false;
    }
    // In double: finite but huge entries must not overflow into a NaN that compares as fine.
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const double deviation = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    return deviation <= static_cast<double>(tolerance) && rotation.determinant() > 0;
}

}  // namespace grapeshot
