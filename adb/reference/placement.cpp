#include <grapeshot/adb/reference/placement.hpp>

#include <Eigen/LU>
#include <cmath>

#include <grapeshot/core/error.hpp>

namespace grapeshot::reference {

Placement::Placement(const Pose& bInA) {
    if (!bInA.rotation.allFinite() || !bInA.translation.allFinite()) {
        throw Error(Fault::notFinite, "a NaN or an infinity", "pose");
    }
    if (!isRigid(bInA)) {
        throw Error(Fault::notRigid, "the rotation is not orthonormal and right-handed", "pose");
    }
    rotation = bInA.rotation.cast<double>();
    translation = bInA.translation.cast<double>();
    inverseRotation = rotation.inverse();
    // The largest eigenvalue of R^T R is at most its largest sum of a row.
    stretch = std::sqrt((rotation.transpose() * rotation).cwiseAbs().rowwise().sum().maxCoeff());
}

}  // namespace grapeshot::reference
