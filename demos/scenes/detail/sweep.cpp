#include "sweep.hpp"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace grapeshot::scenes::detail {

Mesh closedTube(int around, int across, const std::function<Eigen::Vector3d(int, int)>& position) {
    assert(around >= 3 && across >= 3);
    Mesh mesh;
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            mesh.vertices.push_back(position(i, j).cast<float>());
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % around) * across + j % across); };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

Mesh revolved(const std::vector<Eigen::Vector2d>& profile, int around) {
    assert(around >= 3 && profile.size() >= 3);
    Mesh mesh;
    mesh.vertices.push_back({0.0F, static_cast<float>(profile.front().y()), 0.0F});
    for (std::size_t ring = 1; ring + 1 < profile.size(); ++ring) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            mesh.vertices.push_back(Eigen::Vector3d(profile[ring].x() * std::cos(angle), profile[ring].y(),
                                                    -profile[ring].x() * std::sin(angle))
                                        .cast<float>());
        }
    }
    mesh.vertices.push_back({0.0F, static_cast<float>(profile.back().y()), 0.0F});

    const auto first = std::uint32_t{0};
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    const auto at = [&](std::size_t ring, int i) {
        return static_cast<std::uint32_t>(1 + (ring - 1) * static_cast<std::size_t>(around) +
                                          static_cast<std::size_t>(i % around));
    };
    const std::size_t lastRing = profile.size() - 2;
    for (int i = 0; i < around; ++i) {
        mesh.triangles.push_back({first, at(1, i + 1), at(1, i)});
        for (std::size_t ring = 1; ring < lastRing; ++ring) {
            mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
            mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
        }
        mesh.triangles.push_back({at(lastRing, i), at(lastRing, i + 1), last});
    }
    return mesh;
}

}  // namespace grapeshot::scenes::detail
