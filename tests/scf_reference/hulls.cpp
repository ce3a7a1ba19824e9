#include "hulls.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <support/poses.hpp>

namespace grapeshot::test {

namespace {

/// > 0: d is in front of the triangle a, b, c.
double inFront(const scenes::Mesh& mesh, const Triangle& t, std::uint32_t d) {
    const auto at = [&mesh](std::uint32_t v) { return mesh.vertices[v].cast<double>().eval(); };
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).dot(at(d) - at(t[0]));
}

}  // namespace

scenes::Mesh randomHull(int points, const Eigen::Vector3f& half, std::uint64_t seed) {
    Random random(seed);
    scenes::Mesh mesh;
    for (int i = 0; i < points; ++i) {
        mesh.vertices.push_back(random.direction().cwiseProduct(half));
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
    for (std::uint32_t p = 3; p < mesh.vertices.size(); ++p) {
        std::set<std::pair<std::uint32_t, std::uint32_t>> horizon;  // edges of visible faces without their opposites
        std::vector<Triangle> kept;
        for (const Triangle& t : mesh.triangles) {
            if (inFront(mesh, t, p) <= 0) {
                kept.push_back(t);
                continue;
            }
            for (std::size_t e = 0; e < 3; ++e) {
                const std::pair edge(t[e], t[(e + 1) % 3]);
                if (horizon.erase({edge.second, edge.first}) == 0) {
                    horizon.insert(edge);
                }
            }
        }
        for (const auto& [from, to] : horizon) {
            kept.push_back({from, to, p});
        }
        mesh.triangles = std::move(kept);
    }
    return mesh;
}

scenes::Mesh prism(int sides, float radius, float halfHeight) {
    scenes::Mesh mesh;
    const auto n = static_cast<std::uint32_t>(sides);
    for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        for (const float y : {-halfHeight, halfHeight}) {
            mesh.vertices.emplace_back(radius * static_cast<float>(std::cos(angle)), y,
                                       radius * static_cast<float>(std::sin(angle)));
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 2 * i;
        const std::uint32_t b = 2 * ((i + 1) % n);
        mesh.triangles.push_back({a, a + 1, b});
        mesh.triangles.push_back({b, a + 1, b + 1});
        if (i > 0 && i + 1 < n) {
            mesh.triangles.push_back({0, a, b});
            mesh.triangles.push_back({1, b + 1, a + 1});
        }
    }
    return mesh;
}

}  // namespace grapeshot::test
