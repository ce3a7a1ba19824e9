#include <grapeshot/adb/reference/intersection_volume.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace grapeshot::reference {

Box thickened(const Box& box) {
    const Eigen::Vector3d half = 0.5 * box.sides();
    const Eigen::Vector3d thick = half.cwiseMax(Eigen::Vector3d::Constant(thinnestSide * half.maxCoeff()));
    return {box.center() - thick, box.center() + thick};
}

Extent extentOf(const Box& box) {
    Extent extent;
    extent.sides = box.sides();
    std::sort(extent.sides.begin(), extent.sides.end(), std::greater<>());
    extent.volume = extent.sides.prod();
    extent.meanSide = std::cbrt(extent.volume);
    extent.radius = 0.5 * extent.sides.norm();
    return extent;
}

double equalBoxesVolume(const Eigen::Vector3d& sidesLongestFirst, double distance) {
    const double a = sidesLongestFirst[0];
    const double b = sidesLongestFirst[1];
    const double c = sidesLongestFirst[2];
    const auto left = [&](double length) { return std::max(0.0, 1 - distance / length); };
    const double v1 = left(a);
    const double v2 = left(std::sqrt(a * a + b * b));
    const double v3 = left(std::sqrt(a * a + b * b + c * c));
    return a * b * c * std::max({v1, v2 * v2, v3 * v3 * v3});
}

double lensVolume(double radiusA, double radiusB, double distance) {
    using std::numbers::pi;
    const double sum = radiusA + radiusB;
    const double difference = std::abs(radiusA - radiusB);
    if (distance >= sum) {
        return 0;
    }
    if (distance <= difference) {
        return 4 * pi / 3 * std::pow(std::min(radiusA, radiusB), 3);
    }
    return pi * std::pow(sum - distance, 2) * (distance * distance + 2 * distance * sum - 3 * difference * difference) /
           (12 * distance);
}

double intersectionVolume(const Extent& a, const Extent& b, double distance) {
    const Extent& smaller = a.volume < b.volume ? a : b;
    const bool similar = std::max(a.radius, b.radius) <= similarSizes * std::min(a.radius, b.radius);
    const double shared =
        similar ? equalBoxesVolume(smaller.sides, distance) : lensVolume(a.radius, b.radius, distance);
    return std::min(shared, smaller.volume);
}

}  // namespace grapeshot::reference
