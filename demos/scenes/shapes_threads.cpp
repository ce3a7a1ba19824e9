// A rounded screw thread, outside and inside.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <scenes/detail/sweep.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double turn = 2 * std::numbers::pi;

double threadRadius(const Thread& thread, double angle, double y) {
    return thread.radius + thread.depth * std::cos(turn * y / thread.pitch - angle);
}

}  // namespace

Mesh threadedRod(const Thread& thread, float length, int around, int along) {
    assert(thread.depth < thread.radius);
    const double half = 0.5 * length;
    std::vector<Vector2d> profile{{0, -half}};
    for (int k = 0; k <= along; ++k) {
        profile.emplace_back(thread.radius, -half + length * k / along);
    }
    profile.emplace_back(0, half);
    Mesh mesh = detail::revolved(profile, around);
    for (Eigen::Vector3f& v : mesh.vertices) {
        const double angle = std::atan2(-v.z(), v.x());
        const double r = std::hypot(v.x(), v.z());
        if (r > 0) {
            const auto factor = static_cast<float>(threadRadius(thread, angle, v.y()) / r);
            v = {factor * v.x(), v.y(), factor * v.z()};
        }
    }
    return mesh;
}

Mesh threadedNut(const Thread& thread, float clearance, float acrossFlats, float height, int around, int along) {
    assert(around % 6 == 0 && thread.radius + thread.depth + clearance < 0.5F * acrossFlats);
    const int radial = 2;
    const double half = 0.5 * height;
    // Corners of the section, counter-clockwise with the radius to the right: bottom, outside, top, thread.
    return detail::closedTube(around, 2 * (radial + along), [=](int i, int j) {
        double reach = 0;  // 0 in the thread, 1 outside
        double y = 0;
        if (j < radial) {
            reach = static_cast<double>(j) / radial;
            y = -half;
        } else if (j < radial + along) {
            reach = 1;
            y = -half + height * (j - radial) / along;
        } else if (j < 2 * radial + along) {
            reach = 1 - static_cast<double>(j - radial - along) / radial;
            y = half;
        } else {
            y = half - height * (j - 2 * radial - along) / along;
        }
        const double angle = turn * i / around;
        const double fromFlat = std::remainder(angle - turn / 12, turn / 6);
        const double outside = 0.5 * acrossFlats / std::cos(fromFlat);
        const double inside = threadRadius(thread, angle, y) + clearance;
        const double r = inside + reach * (outside - inside);
        return Vector3d(r * std::cos(angle), y, -r * std::sin(angle));
    });
}

}  // namespace grapeshot::scenes
