#include <grapeshot/scf/detail/turning.hpp>

#include <Eigen/Geometry>
#include <cmath>

namespace grapeshot::detail {
namespace {

constexpr double smallAngle = 0.05;  // rad

}  // namespace

Eigen::Matrix3d rotationBy(const Eigen::Vector3d& axisAngle) {
    Eigen::Vector3d sine = 0.5 * axisAngle;
    int halvings = 0;
    while (sine.squaredNorm() > smallAngle * smallAngle && halvings < 64) {
        sine *= 0.5;
        ++halvings;
    }
    const double square = sine.squaredNorm();
    sine *= 1 - square / 6 * (1 - square / 20 * (1 - square / 42 * (1 - square / 72)));
    double cosine = 1 - square / 2 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
    for (; halvings > 0; --halvings) {
        sine *= 2 * cosine;
        cosine = 2 * cosine * cosine - 1;
    }
    return Eigen::Quaterniond(cosine, sine[0], sine[1], sine[2]).normalized().toRotationMatrix();
}

Eigen::Vector3d axisAngleOf(const Eigen::Matrix3d& rotation) {
    Eigen::Quaterniond half(rotation);
    half.normalize();
    if (half.w() < 0) {
        half.coeffs() *= -1;
    }
    Eigen::Vector3d sine = half.vec();
    double cosine = half.w();
    double times = 2;
    while (sine.squaredNorm() > smallAngle * smallAngle) {
        const double length = std::sqrt((1 + cosine) * (1 + cosine) + sine.squaredNorm());
        cosine = (1 + cosine) / length;
        sine /= length;
        times *= 2;
    }
    const double square = sine.squaredNorm();
    const double arcSine = 1 + square * (1.0 / 6 + square * (3.0 / 40 + square * (15.0 / 336 + square * 105.0 / 3456)));
    return times * arcSine * sine;
}

}  // namespace grapeshot::detail
