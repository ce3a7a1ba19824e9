#include <grapeshot/narrowphase/relative_motion.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace grapeshot {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// In double, so that an inverse is one, whatever the rotation is.
struct ExactPose {
    Matrix3d rotation;
    Vector3d translation;
};
ExactPose exact(const Pose& pose) {
    return {pose.rotation.cast<double>(), pose.translation.cast<double>()};
}
ExactPose inverse(const ExactPose& pose) {
    const Matrix3d back = pose.rotation.inverse();
    return {back, -(back * pose.translation)};
}

float roundedUp(double bound) {
    return bound > 0 ? std::nextafter(static_cast<float>(bound * (1 + 1e-12)), INFINITY) : 0.0F;
}

double boundOfAll(const ExactPose& before, const ExactPose& now, double radiusOfB) {
    // The difference of two rotations has two equal singular values and a zero: its spectral norm is its Frobenius norm
    // by sqrt(2). How far each matrix is from a rotation is at most |R^T R - I|, and comes on top.
    const auto offOf = [](const Matrix3d& r) { return (r.transpose() * r - Matrix3d::Identity()).norm(); };
    const double off = offOf(before.rotation) + offOf(now.rotation);
    const double turn = ((now.rotation - before.rotation).norm() + off) / std::sqrt(2.0) + off;
    return turn * radiusOfB + (now.translation - before.translation).norm();
}

double boundOfNear(const Tree& a, const Tree& b, const ExactPose& before, const ExactPose& now, double reach) {
    const Vector3d lowerB = b.lower.cast<double>();
    const Vector3d upperB = b.upper.cast<double>();
    const Vector3d centre = now.rotation * (lowerB + upperB) / 2 + now.translation;
    const Vector3d extent = now.rotation.cwiseAbs() * (upperB - lowerB) / 2;
    const Vector3d lower = (a.lower.cast<double>().array() - reach).max((centre - extent).array());
    const Vector3d upper = (a.upper.cast<double>().array() + reach).min((centre + extent).array());
    if ((lower.array() > upper.array()).any()) {
        return 0;
    }
    // Where a point at y now was before: R0 R1^-1 (y - t1) + t0. What it has moved is affine in y, so it is largest at
    // a corner.
    const Matrix3d back = before.rotation * now.rotation.inverse();
    const Matrix3d turn = back - Matrix3d::Identity();
    const Vector3d offset = before.translation - back * now.translation;
    double farthest = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vector3d y((corner & 1U) != 0 ? upper.x() : lower.x(), (corner & 2U) != 0 ? upper.y() : lower.y(),
                         (corner & 4U) != 0 ? upper.z() : lower.z());
        farthest = std::max(farthest, (turn * y + offset).squaredNorm());
    }
    return std::sqrt(farthest);
}

}  // namespace

float motionBound(const Pose& before, const Pose& now, float radiusOfB) {
    return roundedUp(boundOfAll(exact(before), exact(now), static_cast<double>(radiusOfB)));
}

float nearMotionBound(const Tree& a, const Tree& b, const Pose& before, const Pose& now, float reach) {
    return roundedUp(boundOfNear(a, b, exact(before), exact(now), static_cast<double>(reach)));
}

float boxMotionBound(const Tree& a, const Pose& before, const Pose& now) {
    const ExactPose first = inverse(exact(before));
    const ExactPose second = inverse(exact(now));
    // What a point of A has moved in B's frame is affine in it, so it is largest at a corner.
    const Matrix3d turn = second.rotation - first.rotation;
    const Vector3d offset = second.translation - first.translation;
    double farthest = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vector3d x =
            Vector3f((corner & 1U) != 0 ? a.upper.x() : a.lower.x(), (corner & 2U) != 0 ? a.upper.y() : a.lower.y(),
                     (corner & 4U) != 0 ? a.upper.z() : a.lower.z())
                .cast<double>();
        farthest = std::max(farthest, (turn * x + offset).squaredNorm());
    }
    return roundedUp(std::sqrt(farthest));
}

bool movedAtMost(float limit, const Tree& a, const Tree& b, const Pose& before, const Pose& now, float reach) {
    // The vertices, and where the poses put them, are rounded.
    const double rounding = 4e-6 * static_cast<double>(a.radius + b.radius);
    const double most = static_cast<double>(limit) - rounding;
    const double within = static_cast<double>(reach) + rounding;
    const ExactPose first = exact(before);
    const ExactPose second = exact(now);
    if (boundOfAll(first, second, static_cast<double>(b.radius)) <= most) {
        return true;
    }
    const ExactPose firstOfA = inverse(first);
    const ExactPose secondOfA = inverse(second);
    // Distances in B's frame are those in A's but for the stretch of a rotation that is not quite one.
    const double stretch = 1 + (second.rotation.transpose() * second.rotation - Matrix3d::Identity()).norm();
    return boundOfNear(a, b, first, second, within) <= most ||
           stretch * boundOfAll(firstOfA, secondOfA, static_cast<double>(a.radius)) <= most ||
           stretch * boundOfNear(b, a, firstOfA, secondOfA, stretch * within) <= most;
}

}  // namespace grapeshot
