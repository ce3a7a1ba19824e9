#include "tracking_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
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

TrackingFrame twoBodiesAt(const TrackingScene& scene, float depth, float frame, int frames) {
    const float time = frame / static_cast<float>(frames);  // 0..1
    const float phase = 0.15F * frame;
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

float farthestMove(const std::vector<Eigen::Vector3f>& from, const std::vector<Eigen::Vector3f>& to) {
    float square = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        square = std::max(square, (to[i] - from[i]).squaredNorm());
    }
    return std::sqrt(square);
}

TrackSettings settingsOf(const TrackingScene& scene, const TrackingBudget& budget, std::uint64_t seed) {
    TrackSettings settings;
    settings.maxDistance = scene.maxDistance;
    settings.spacing = scene.spacing;
    settings.exclusion = scene.exclusion;
    settings.frontCells = budget.frontCells;
    settings.auditShare = budget.auditShare;
    settings.lookAhead = budget.lookAhead;
    settings.maxDives = 1U << 20U;
    settings.seed = seed;
    return settings;
}

}  // namespace grapeshot::bench
