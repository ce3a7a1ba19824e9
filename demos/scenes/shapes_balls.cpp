// Shapes over the sphere: an icosahedron cut finely, every point moved along its ray.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include <grapeshot/core/random.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

using Eigen::Vector3d;

namespace {

struct UnitSphere {
    std::vector<Vector3d> directions;
    std::vector<Triangle> triangles;
};

constexpr std::array<std::array<int, 3>, 20> icosahedronFaces{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

std::array<Vector3d, 12> icosahedronCorners() {
    const double g = std::numbers::phi;
    return {{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}}};
}

UnitSphere unitSphere(int frequency) {
    assert(frequency >= 1);
    const std::array<Vector3d, 12> corners = icosahedronCorners();
    UnitSphere sphere;
    // A point is known by its weights of the (at most three) corners around it, so that neighbouring faces share it.
    using Weight = std::pair<int, int>;
    std::map<std::array<Weight, 3>, std::uint32_t> known;
    const auto vertex = [&](const std::array<int, 3>& face, int i, int j) {
        std::array<Weight, 3> key{{{face[0], frequency - i - j}, {face[1], i}, {face[2], j}}};
        for (Weight& weight : key) {
            weight.first = weight.second == 0 ? -1 : weight.first;
        }
        std::ranges::sort(key);
        const auto [entry, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(sphere.directions.size()));
        if (fresh) {
            Vector3d p = Vector3d::Zero();
            for (const auto& [corner, weight] : key) {
                if (weight > 0) {
                    p += weight * corners[static_cast<std::size_t>(corner)];
                }
            }
            sphere.directions.push_back(p.normalized());
        }
        return entry->second;
    };
    for (const auto& face : icosahedronFaces) {
        for (int i = 0; i < frequency; ++i) {
            for (int j = 0; j < frequency - i; ++j) {
                sphere.triangles.push_back({vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1)});
                if (i + j + 1 < frequency) {
                    sphere.triangles.push_back(
                        {vertex(face, i + 1, j), vertex(face, i + 1, j + 1), vertex(face, i, j + 1)});
                }
            }
        }
    }
    return sphere;
}

template <class Radius>
Mesh along(const UnitSphere& sphere, const Radius& radius) {
    Mesh mesh;
    for (const Vector3d& direction : sphere.directions) {
        mesh.vertices.push_back((radius(direction) * direction).template cast<float>());
    }
    mesh.triangles = sphere.triangles;
    return mesh;
}

/// `count` directions, evenly spread (a golden-angle spiral).
std::vector<Vector3d> spread(int count) {
    std::vector<Vector3d> directions;
    const double goldenAngle = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double y = 1 - (2.0 * i + 1) / count;
        const double r = std::sqrt(1 - y * y);
        directions.emplace_back(r * std::cos(goldenAngle * i), y, r * std::sin(goldenAngle * i));
    }
    return directions;
}

}  // namespace

Mesh sphere(float radius, int frequency) {
    return along(unitSphere(frequency), [=](const Vector3d&) { return static_cast<double>(radius); });
}

Mesh spikedBall(float radius, float spikeLength, int spikes, int triangles) {
    assert(spikes >= 1);
    const std::vector<Vector3d> tips = spread(spikes);
    // Mean spacing of the tips on the unit sphere; the mesh is at least four times as fine.
    const double spacing = std::sqrt(4 * std::numbers::pi / spikes);
    const int coarsest = static_cast<int>(std::ceil(4 * 1.1 / spacing));
    const int frequency = std::max(coarsest, static_cast<int>(std::lround(std::sqrt(triangles / 20.0))));
    UnitSphere ball = unitSphere(frequency);
    // The nearest vertex becomes the tip, or the spikes would be as blunt as the mesh is coarse.
    for (const Vector3d& tip : tips) {
        *std::ranges::max_element(ball.directions, {}, [&](const Vector3d& d) { return d.dot(tip); }) = tip;
    }
    const double foot = 0.35 * spacing;
    const double tipRadius = static_cast<double>(radius) + spikeLength;
    // A straight flank in polar form: 1 / r = a cos(angle) + b sin(angle).
    const double a = 1 / tipRadius;
    const double b = (1 / static_cast<double>(radius) - a * std::cos(foot)) / std::sin(foot);
    return along(ball, [&](const Vector3d& direction) {
        double reach = radius;
        for (const Vector3d& tip : tips) {
            const double angle = std::atan2(direction.cross(tip).norm(), direction.dot(tip));
            if (angle < foot) {
                reach = std::max(reach, 1 / (a * std::cos(angle) + b * std::sin(angle)));
            }
        }
        return reach;
    });
}

Mesh bumpySphere(float radius, float amplitude, int lobes, int frequency, std::uint32_t seed) {
    assert(amplitude < radius);
    struct Wave {
        Vector3d axis;
        double phase;
    };
    std::array<Wave, 3> waves;
    for (std::uint32_t w = 0; w < waves.size(); ++w) {
        const auto draw = [&](std::uint32_t k) {
            return static_cast<double>(randomUnit({.seed = seed, .pair = 0, .step = 0}, 3 * w + k));
        };
        const double y = 2 * draw(0) - 1;
        const double longitude = 2 * std::numbers::pi * draw(1);
        const double r = std::sqrt(1 - y * y);
        waves[w] = {{r * std::cos(longitude), y, r * std::sin(longitude)}, 2 * std::numbers::pi * draw(2)};
    }
    return along(unitSphere(frequency), [&](const Vector3d& direction) {
        double height = 0;
        for (const Wave& wave : waves) {
            height += std::sin(lobes * direction.dot(wave.axis) + wave.phase) / static_cast<double>(waves.size());
        }
        return radius + amplitude * height;
    });
}

}  // namespace grapeshot::scenes
