#include "tracking_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float coilLength = 3.93F;  // m

/// A tube along x, open at both ends, with low bumps.
scenes::Mesh straightTube(int along, int around) {
    scenes::Mesh mesh;
    for (int i = 0; i <= along; ++i) {
        const float s = coilLength * static_cast<float>(i) / static_cast<float>(along);
        for (int j = 0; j < around; ++j) {
            const float angle = 2 * pi * static_cast<float>(j) / static_cast<float>(around);
            const float radius = coilTubeRadius * (1 + 0.04F * std::sin(40 * s) * std::cos(3 * angle));
            mesh.vertices.emplace_back(s, radius * std::cos(angle), radius * std::sin(angle));
        }
    }
    const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(i * around + j % around); };
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < around; ++j) {
            mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    return mesh;
}

std::vector<Eigen::Vector3f> waved(const scenes::Mesh& mesh, float phase) {
    std::vector<Eigen::Vector3f> moved = mesh.vertices;
    for (Eigen::Vector3f& vertex : moved) {
        vertex[1] += 0.05F * std::sin(4 * vertex[0] + phase);
        vertex[2] += 0.03F * std::sin(5 * vertex[1] - phase);
    }
    return moved;
}

}  // namespace

TrackingScene twoBodies(const std::string& name, int frequency, std::uint32_t seed) {
    TrackingScene scene;
    scene.name = name;
    scene.a = scenes::normalised(scenes::bumpySphere(1.0F, 0.27F, 13, frequency, seed));
    scene.b = scenes::normalised(scenes::bumpySphere(1.0F, 0.22F, 9, frequency, seed + 1));
    scene.maxDistance = 0.004F;
    scene.spacing = 0.04F;
    return scene;
}

TrackingFrame twoBodiesAt(const TrackingScene& scene, float depth, int frame, int frames) {
    const float time = static_cast<float>(frame) / static_cast<float>(frames);  // 0..1
    const float phase = 0.15F * static_cast<float>(frame);
    TrackingFrame result{waved(scene.a, phase), waved(scene.b, 1.7F * phase)};
    // Along x there and back, drifting past.
    const float gap = 1.15F - depth * std::sin(pi * time);
    const Eigen::Vector3f offset(gap, 0.25F * time - 0.1F, 0.1F * std::sin(5 * time));
    for (Eigen::Vector3f& vertex : result.b) {
        vertex += offset;
    }
    return result;
}

TrackingFrame twoBodiesTurned(const TrackingScene& scene, const Eigen::Matrix3f& turnA, const Eigen::Matrix3f& turnB,
                              float gap, float phase) {
    TrackingFrame result{waved(scene.a, phase), waved(scene.b, 1.7F * phase)};
    for (Eigen::Vector3f& vertex : result.a) {
        vertex = turnA * vertex;
    }
    for (Eigen::Vector3f& vertex : result.b) {
        vertex = turnB * vertex + Eigen::Vector3f(gap, 0, 0);
    }
    return result;
}

TrackingScene coil(const std::string& name, std::size_t triangles) {
    // As many around as makes the triangles even: 2 along around, with along / around = length / (2 pi radius).
    const double aspect = coilLength / (2 * pi * coilTubeRadius);
    const int around =
        std::max(6, static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / (2 * aspect)))));
    const int along = static_cast<int>(std::lround(static_cast<double>(triangles) / (2.0 * around)));
    TrackingScene scene;
    scene.name = name;
    scene.a = straightTube(along, around);
    scene.maxDistance = 0.002F;
    scene.spacing = 1.25F * coilTubeRadius;  // chosen on another coil: thicker, narrower turns, other waves
    scene.exclusion = 3 * coilTubeRadius;
    return scene;
}

TrackingFrame coilAt(const TrackingScene& scene, int frame) {
    constexpr float turnRadius = 0.15F;
    const float phase = 0.12F * static_cast<float>(frame);
    const float pitch = 2 * coilTubeRadius * (1.0F + 0.04F * std::sin(0.05F * static_cast<float>(frame)));
    TrackingFrame result;
    result.a.reserve(scene.a.vertices.size());
    for (const Eigen::Vector3f& vertex : scene.a.vertices) {
        const float turn = vertex[0] / turnRadius;  // rad
        // Turns next to each other are half a wave apart: they sway against each other.
        const float sway = 0.006F * std::sin(2.5F * turn + phase);
        const float lift = 0.004F * std::sin(3.5F * turn - 0.7F * phase);
        const float out = turnRadius + sway + vertex[1];
        result.a.emplace_back(out * std::cos(turn), out * std::sin(turn), pitch * turn / (2 * pi) + lift + vertex[2]);
    }
    return result;
}

}  // namespace grapeshot::bench
