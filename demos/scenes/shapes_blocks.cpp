// Shapes whose solid is a set of lattice cells, straight or bent.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <scenes/detail/lattice.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

using detail::Lattice;
using detail::refined;
using Eigen::Vector3d;

Mesh box(const Eigen::Vector3f& half, int cells) {
    const Vector3d h = half.cast<double>();
    return detail::boundary({.x = refined({-h.x(), h.x()}, cells),
                             .y = refined({-h.y(), h.y()}, cells),
                             .z = refined({-h.z(), h.z()}, cells)});
}

Mesh crenelBlock(const Eigen::Vector3f& half, int teeth, int cells) {
    assert(teeth >= 1);
    const Vector3d h = half.cast<double>();
    const int columns = 2 * teeth - 1;
    const double pitch = 2 * h.x() / columns;
    const double gapFloor = 0.5 * h.y();
    Lattice lattice{.x = refined({-h.x(), h.x()}, columns * cells),
                    .y = refined({-h.y(), gapFloor, h.y()}, cells),
                    .z = refined({-h.z(), h.z()}, cells)};
    lattice.filled = [=](const Vector3d& p) {
        return p.y() < gapFloor || static_cast<int>((p.x() + h.x()) / pitch) % 2 == 0;
    };
    return detail::boundary(lattice);
}

Mesh archBlock(const Eigen::Vector3f& half, float archRadius, int segments, int cells) {
    const Vector3d h = half.cast<double>();
    const double radius = archRadius;
    assert(radius < h.x() && radius < 2 * h.y() && segments >= 4);
    // The cross-section is a half ring between the arch and the outline of the block; the angle is about the middle of
    // the arch's base, and the outline's corners are at angles of their own.
    const double corner = std::atan2(2 * h.y(), h.x());
    const double pi = std::numbers::pi;
    const int side = std::max(1, static_cast<int>(std::lround(segments * corner / pi)));
    const int top = std::max(1, segments - 2 * side);
    std::vector<double> angles = refined({-pi, corner - pi}, side * cells);
    const std::vector<double> overhead = refined({corner - pi, -corner}, top * cells);
    const std::vector<double> rest = refined({-corner, 0.0}, side * cells);
    angles.insert(angles.end(), overhead.begin() + 1, overhead.end());
    angles.insert(angles.end(), rest.begin() + 1, rest.end());

    Lattice lattice{.x = angles, .y = refined({0.0, 1.0}, cells), .z = refined({-h.z(), h.z()}, cells)};
    lattice.position = [=](const Vector3d& p) -> Vector3d {
        const double c = std::cos(p.x());
        const double s = std::max(0.0, -std::sin(p.x()));
        const double toSide = std::abs(c) > 1e-12 ? h.x() / std::abs(c) : 1e30;
        const double toTop = s > 1e-12 ? 2 * h.y() / s : 1e30;
        const double reach = radius + p.y() * (std::min(toSide, toTop) - radius);
        return {reach * c, (p.x() == 0.0 || p.x() == -pi ? 0.0 : reach * s) - h.y(), p.z()};
    };
    return detail::boundary(lattice);
}

Mesh uBody(float width, float legLength, float thickness, float depth, int cells) {
    const double x = 0.5 * width;
    const double y = 0.5 * (legLength + thickness);
    const double t = thickness;
    assert(t < x);
    Lattice lattice{.x = refined({-x, -x + t, x - t, x}, cells),
                    .y = refined({-y, y - t, y}, cells),
                    .z = refined({-0.5 * depth, 0.5 * depth}, cells)};
    lattice.filled = [=](const Vector3d& p) { return p.y() > y - t || std::abs(p.x()) > x - t; };
    return detail::boundary(lattice);
}

Mesh crossPlug(float arm, float thickness, float height, int cells) {
    const double a = arm;
    const double t = 0.5 * thickness;
    assert(t < a);
    const std::vector<double> across = refined({-a, -t, t, a}, cells);
    Lattice lattice{.x = across, .y = refined({-0.5 * height, 0.5 * height}, cells), .z = across};
    lattice.filled = [=](const Vector3d& p) { return std::abs(p.x()) < t || std::abs(p.z()) < t; };
    return detail::boundary(lattice);
}

Mesh plateWithCrossHole(float half, float thickness, float arm, float holeThickness, float clearance, int cells) {
    const double h = half;
    const double a = static_cast<double>(arm) + clearance;
    const double t = 0.5 * holeThickness + clearance;
    assert(t < a && a < h);
    const std::vector<double> across = refined({-h, -a, -t, t, a, h}, cells);
    Lattice lattice{.x = across, .y = refined({-0.5 * thickness, 0.5 * thickness}, cells), .z = across};
    lattice.filled = [=](const Vector3d& p) {
        const double x = std::abs(p.x());
        const double z = std::abs(p.z());
        return !((x < t && z < a) || (z < t && x < a));
    };
    return detail::boundary(lattice);
}

Mesh comb(int teeth, float toothLength, float pitch, float thickness, int cells) {
    assert(teeth >= 1);
    const int columns = 2 * teeth - 1;
    const double column = 0.5 * pitch;
    const double x = 0.5 * columns * column;
    const double y = 0.5 * (static_cast<double>(toothLength) + thickness);
    Lattice lattice{.x = refined({-x, x}, columns * cells),
                    .y = refined({-y, y - thickness, y}, cells),
                    .z = refined({-0.5 * thickness, 0.5 * thickness}, cells)};
    lattice.filled = [=](const Vector3d& p) {
        return p.y() > y - thickness || static_cast<int>((p.x() + x) / column) % 2 == 0;
    };
    return detail::boundary(lattice);
}

Mesh voussoir(float innerRadius, float outerRadius, float angle, float depth, int cells) {
    assert(0 < innerRadius && innerRadius < outerRadius && angle < 3);
    // The lattice's x runs against the angle, so that x, y (outwards), z are right-handed.
    Lattice lattice{.x = refined({-0.5 * angle, 0.5 * angle}, 2 * cells),
                    .y = refined({innerRadius, outerRadius}, cells),
                    .z = refined({-0.5 * depth, 0.5 * depth}, cells)};
    lattice.position = [](const Vector3d& p) {
        return Vector3d(p.y() * std::sin(p.x()), p.y() * std::cos(p.x()), p.z());
    };
    return detail::boundary(lattice);
}

}  // namespace grapeshot::scenes
