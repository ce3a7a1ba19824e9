#include <grapeshot/adb/detail/pose_range.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::detail {
namespace {

constexpr double nearest = 0.2;  // of the mean bounding diameter
constexpr double farthest = 1.05;
constexpr int distances = 12;

}  // namespace

Eigen::Vector3d middleOf(const Tree& tree) {
    return 0.5 * (tree.lower.cast<double>() + tree.upper.cast<double>());
}

double boundingDiameter(const Tree& tree) {
    const Eigen::Vector3d middle = middleOf(tree);
    double squared = 0;
    for (const Triangle& triangle : tree.triangles) {
        for (const std::uint32_t corner : triangle) {
            squared = std::max(squared, (tree.vertices[corner].cast<double>() - middle).squaredNorm());
        }
    }
    return 2 * std::sqrt(squared);
}

Eigen::Vector3d directionFrom(double u, double v) {
    const double z = 2 * u - 1;
    const double longitude = 2 * std::numbers::pi * v;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(longitude), r * std::sin(longitude), z};
}

Eigen::Matrix3d rotationFrom(double u, double v, double t) {
    const double a = 2 * std::numbers::pi * v;
    const double b = 2 * std::numbers::pi * t;
    const double w = std::sqrt(1 - u) * std::sin(a);
    const double x = std::sqrt(1 - u) * std::cos(a);
    const double y = std::sqrt(u) * std::sin(b);
    const double z = std::sqrt(u) * std::cos(b);
    Eigen::Matrix3d m;
    m << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return m;
}

PoseRange::PoseRange(const Tree& a, const Tree& b)
    : m_middleA(middleOf(a)), m_middleB(middleOf(b)), m_diameter(boundingDiameter(a)) {
    if (&a != &b) {
        m_diameter = 0.5 * (m_diameter + boundingDiameter(b));
    }
}

Pose PoseRange::at(const std::array<double, 6>& unit) const {
    const double share = std::floor(unit[0] * distances) / (distances - 1);
    const double distance = (nearest + share * (farthest - nearest)) * m_diameter;
    const Eigen::Matrix3f rotation = rotationFrom(unit[1], unit[2], unit[3]).cast<float>();
    const Eigen::Vector3d place = m_middleA + distance * directionFrom(unit[4], unit[5]);
    return {rotation, (place - rotation.cast<double>() * m_middleB).cast<float>()};
}

}  // namespace grapeshot::detail
