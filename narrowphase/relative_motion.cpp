#include <grapeshot/narrowphase/relative_motion.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace grapeshot {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

float roundedUp(double bound) {
    return std::nextafter(static_cast<float>(bound * (1 + 1e-12)), INFINITY);
}

}  // namespace

float motionBound(const Pose& before, const Pose& now, float radiusOfB) {
    const Matrix3d first = before.rotation.cast<double>();
    const Matrix3d second = now.rotation.cast<double>();
    // The difference of two rotations has two equal singular values and a zero: its spectral norm is its Frobenius norm
    // by sqrt(2). How far each matrix is from a rotation is at most |R^T R - I|, and comes on top.
    const double offFirst = (first.transpose() * first - Matrix3d::Identity()).norm();
    const double offSecond = (second.transpose() * second - Matrix3d::Identity()).norm();
    const double off = offFirst + offSecond;
    const double turn = ((second - first).norm() + off) / std::sqrt(2.0) + off;
    const double shift = (now.translation.cast<double>() - before.translation.cast<double>()).norm();
    return roundedUp(turn * static_cast<double>(radiusOfB) + shift);
}

float nearMotionBound(const Tree& a, const Tree& b, const Pose& before, const Pose& now, float reach) {
    const Matrix3d first = before.rotation.cast<double>();
    const Matrix3d second = now.rotation.cast<double>();
    const Vector3d shift = now.translation.cast<double>();
    const Vector3d middleB = ((b.lower + b.upper) / 2).cast<double>();
    const Vector3d halfB = ((b.upper - b.lower) / 2).cast<double>();
    const Vector3d centre = second * middleB + shift;
    const Vector3d extent = second.cwiseAbs() * halfB;
    const auto distance = static_cast<double>(reach);
    const Vector3d lower = (a.lower.cast<double>().array() - distance).max((centre - extent).array());
    const Vector3d upper = (a.upper.cast<double>().array() + distance).min((centre + extent).array());
    if ((lower.array() > upper.array()).any()) {
        return 0;
    }
    // Where a point at y now was before: first * second^-1 (y - shift) + translation. What it has moved is affine in y,
    // so it is largest at a corner.
    const Matrix3d back = first * second.inverse();
    const Matrix3d turn = back - Matrix3d::Identity();
    const Vector3d offset = before.translation.cast<double>() - back * shift;
    double farthest = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vector3d y((corner & 1U) != 0 ? upper.x() : lower.x(), (corner & 2U) != 0 ? upper.y() : lower.y(),
                         (corner & 4U) != 0 ? upper.z() : lower.z());
        farthest = std::max(farthest, (turn * y + offset).squaredNorm());
    }
    return roundedUp(std::sqrt(farthest));
}

bool movedAtMost(float limit, const Tree& a, const Tree& b, const Pose& before, const Pose& now, float reach) {
    const float rounding = 4e-6F * (a.radius + b.radius);
    if (motionBound(before, now, b.radius) + rounding <= limit) {
        return true;
    }
    const Pose beforeOfA = inverse(before);
    const Pose nowOfA = inverse(now);
    // The inverse poses are rounded, and as exact as the rotations are orthonormal.
    const float inverted = rounding + 1e-6F * (before.translation.norm() + now.translation.norm());
    return motionBound(beforeOfA, nowOfA, a.radius) + inverted <= limit ||
           nearMotionBound(a, b, before, now, reach + rounding) + rounding <= limit ||
           nearMotionBound(b, a, beforeOfA, nowOfA, reach + inverted) + inverted <= limit;
}

}  // namespace grapeshot
