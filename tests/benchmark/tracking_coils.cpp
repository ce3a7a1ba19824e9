#include "tracking_coils.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

namespace {

constexpr float fullTurn = 2 * std::numbers::pi_v<float>;  // rad

/// A tube along x, open at both ends, with low bumps.
scenes::Mesh straightTube(const CoilShape& shape, int along, int around) {
    scenes::Mesh mesh;
    for (int i = 0; i <= along; ++i) {
        const float s = shape.length * static_cast<float>(i) / static_cast<float>(along);
        for (int j = 0; j < around; ++j) {
            const float angle = fullTurn * static_cast<float>(j) / static_cast<float>(around);
            const float radius = shape.tubeRadius *
                                 (1 + shape.bump * std::sin(shape.bumpAlong * s) * std::cos(shape.bumpAround * angle));
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

float heightOf(const CoilWave& wave, float turn, float phase) {
    return wave.height * std::sin(wave.perTurn * turn + wave.speed * phase);
}

}  // namespace

TrackingScene coil(const std::string& name, const CoilShape& shape, std::size_t triangles) {
    // As many around as makes the triangles even: 2 along around, with along / around = length / (2 pi radius).
    const double aspect = shape.length / (fullTurn * shape.tubeRadius);
    const int around =
        std::max(6, static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / (2 * aspect)))));
    const int along = static_cast<int>(std::lround(static_cast<double>(triangles) / (2.0 * around)));
    TrackingScene scene;
    scene.name = name;
    scene.a = straightTube(shape, along, around);
    scene.maxDistance = shape.maxDistance;
    scene.spacing = shape.spacing;
    scene.exclusion = 3 * shape.tubeRadius;
    return scene;
}

TrackingFrame coilAt(const TrackingScene& scene, const CoilShape& shape, float frame) {
    const float phase = shape.phase * frame;
    const float pitch = 2 * shape.tubeRadius * (1.0F + shape.breath * std::sin(shape.breathPhase * frame));
    TrackingFrame result;
    result.a.reserve(scene.a.vertices.size());
    for (const Eigen::Vector3f& vertex : scene.a.vertices) {
        const float turn = vertex[0] / shape.turnRadius;  // rad
        // Turns next to each other are half a wave apart: they sway against each other.
        const float out = shape.turnRadius + heightOf(shape.sway, turn, phase) + vertex[1];
        result.a.emplace_back(out * std::cos(turn), out * std::sin(turn),
                              pitch * turn / fullTurn + heightOf(shape.lift, turn, phase) + vertex[2]);
    }
    return result;
}

}  // namespace grapeshot::bench
