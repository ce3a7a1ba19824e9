// Shapes swept out by a curve.
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <scenes/detail/lattice.hpp>
#include <scenes/detail/sweep.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double turn = 2 * std::numbers::pi;

}  // namespace

Mesh torus(float ringRadius, float tubeRadius, int around, int across) {
    assert(tubeRadius < ringRadius);
    return detail::closedTube(around, across, [=](int i, int j) {
        const double u = turn * i / around;
        const double v = turn * j / across;
        const double reach = ringRadius + tubeRadius * std::cos(v);
        return Vector3d(reach * std::cos(u), tubeRadius * std::sin(v), -reach * std::sin(u));
    });
}

Mesh ring(float ringRadius, float tubeRadius, int around, int across) {
    return torus(ringRadius, tubeRadius, around, across);
}

Mesh chainShot(float ringRadius, float tubeRadius, int around, int across) {
    assert(2 * tubeRadius < ringRadius);
    const float shift = 0.5F * ringRadius;
    const Mesh lying = moved(ring(ringRadius, tubeRadius, around, across), {-shift, 0.0F, 0.0F});
    Mesh standing = ring(ringRadius, tubeRadius, around, across);
    for (Eigen::Vector3f& v : standing.vertices) {
        v = Eigen::Vector3f(v.x(), -v.z(), v.y());
    }
    return merged(lying, standing, {shift, 0.0F, 0.0F});
}

Mesh torusKnot(int p, int q, float ringRadius, float knotRadius, float tubeRadius, int along, int across) {
    assert(p >= 1 && q >= 1 && knotRadius < ringRadius);
    return detail::closedTube(along, across, [=](int i, int j) -> Vector3d {
        const double t = turn * i / along;
        const double longitude = p * t;
        const double latitude = q * t;
        const Vector3d outward(std::cos(longitude), 0, -std::sin(longitude));
        const Vector3d sideways(-std::sin(longitude), 0, -std::cos(longitude));
        const double reach = ringRadius + knotRadius * std::cos(latitude);
        const Vector3d centre = reach * outward + Vector3d(0, knotRadius * std::sin(latitude), 0);
        const Vector3d tangent =
            (p * reach * sideways +
             q * knotRadius * (-std::sin(latitude) * outward + std::cos(latitude) * Vector3d::UnitY()))
                .normalized();
        // The curve lies on a torus, whose normal is a frame that closes without a twist.
        const Vector3d normal = std::cos(latitude) * outward + std::sin(latitude) * Vector3d::UnitY();
        const Vector3d binormal = tangent.cross(normal);
        const double v = turn * j / across;
        return centre + tubeRadius * (std::cos(v) * normal - std::sin(v) * binormal);
    });
}

Mesh gear(float radius, float toothHeight, float holeRadius, float thickness, int teeth, int cells) {
    assert(teeth >= 3 && holeRadius < radius - toothHeight);
    const int around = teeth * 4 * cells;
    const int radial = 2 * cells;
    const int axial = cells;
    const double root = radius - toothHeight;
    const double y = 0.5 * thickness;
    // A tooth takes four quarters of its pitch: flank up, tip, flank down, root.
    const auto rim = [=](int i) {
        const double quarter = static_cast<double>(i % (4 * cells)) / cells;
        const double rise = quarter < 1 ? quarter : quarter < 2 ? 1 : quarter < 3 ? 3 - quarter : 0;
        return root + toothHeight * rise;
    };
    // Corners of the radial section, counter-clockwise with the radius to the right: bottom, rim, top, hole.
    return detail::closedTube(around, 2 * (radial + axial), [=](int i, int j) {
        double reach = 0;  // 0 at the hole, 1 at the rim
        double height = 0;
        if (j < radial) {
            reach = static_cast<double>(j) / radial;
            height = -y;
        } else if (j < radial + axial) {
            reach = 1;
            height = -y + 2 * y * (j - radial) / axial;
        } else if (j < 2 * radial + axial) {
            reach = 1 - static_cast<double>(j - radial - axial) / radial;
            height = y;
        } else {
            height = y - 2 * y * (j - 2 * radial - axial) / axial;
        }
        const double angle = turn * i / around;
        const double r = holeRadius + reach * (rim(i) - holeRadius);
        return Vector3d(r * std::cos(angle), height, -r * std::sin(angle));
    });
}

Mesh cup(float radius, float wall, float height, int around, int along) {
    assert(wall < radius && wall < height);
    const double inner = radius - wall;
    const double low = -0.5 * height;
    const double high = 0.5 * height;
    const int acrossFloor = std::max(1, static_cast<int>(std::lround(along * radius / height)));
    std::vector<Vector2d> profile{{0, low}};
    const auto lineTo = [&](double r, double y, int pieces) {
        const Vector2d from = profile.back();
        for (int k = 1; k <= pieces; ++k) {
            profile.push_back(from + (Vector2d(r, y) - from) * k / pieces);
        }
    };
    lineTo(radius, low, acrossFloor);
    lineTo(radius, high, along);
    lineTo(inner, high, 1);
    lineTo(inner, low + wall, along);
    lineTo(0, low + wall, acrossFloor);
    return detail::revolved(profile, around);
}

Mesh grid(float halfX, float halfZ, int cellsX, int cellsZ) {
    assert(cellsX >= 1 && cellsZ >= 1);
    Mesh mesh;
    for (int i = 0; i <= cellsX; ++i) {
        for (int k = 0; k <= cellsZ; ++k) {
            const double x = halfX * (2.0 * i / cellsX - 1);
            const double z = halfZ * (2.0 * k / cellsZ - 1);
            mesh.vertices.push_back(Vector3d(x, 0, z).cast<float>());
        }
    }
    const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * (cellsZ + 1) + k); };
    for (int i = 0; i < cellsX; ++i) {
        for (int k = 0; k < cellsZ; ++k) {
            mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
        }
    }
    return mesh;
}

}  // namespace grapeshot::scenes
