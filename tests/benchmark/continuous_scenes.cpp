#include "continuous_scenes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

namespace {

constexpr float half = 0.35355F;  // m: diagonal 1
constexpr float holeRadius = 0.03F;
constexpr float holeOf[4][2] = {{0.15F, 0.1F}, {-0.2F, 0.05F}, {0.05F, -0.22F}, {-0.1F, -0.15F}};

float heightAt(float x, float z, float phase) {
    return 0.04F * std::sin(9 * x + phase) + 0.03F * std::sin(11 * z - 1.3F * phase + 2 * x);
}

/// Pointed at both ends, along y.
scenes::Mesh spindle() {
    constexpr int around = 11;
    constexpr std::array<float, 6> heights{-0.04F, -0.02F, 0, 0.02F, 0.04F, 0.045F};
    scenes::Mesh mesh;
    for (const float y : heights) {
        for (int i = 0; i < around; ++i) {
            const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / around;
            mesh.vertices.emplace_back(0.003F * std::cos(angle), y, 0.003F * std::sin(angle));
        }
    }
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0.0F, -0.05F, 0.0F);
    mesh.vertices.emplace_back(0.0F, 0.05F, 0.0F);
    const auto last = static_cast<std::uint32_t>(heights.size() - 1);
    for (std::uint32_t i = 0; i < around; ++i) {
        const std::uint32_t next = (i + 1) % around;
        for (std::uint32_t ring = 0; ring < last; ++ring) {
            const std::uint32_t low = ring * around;
            const std::uint32_t high = low + around;
            mesh.triangles.push_back({low + i, high + i, high + next});
            mesh.triangles.push_back({low + i, high + next, low + next});
        }
        mesh.triangles.push_back({bottom, i, next});
        mesh.triangles.push_back({bottom + 1, last * around + next, last * around + i});
    }
    return mesh;
}

}  // namespace

TunnelScene::TunnelScene(int cells) : cloth(scenes::grid(half, half, cells, cells)), needle(spindle()) {
    std::erase_if(cloth.triangles, [&](const Triangle& t) {
        const Eigen::Vector3f middle = (cloth.vertices[t[0]] + cloth.vertices[t[1]] + cloth.vertices[t[2]]) / 3;
        return std::ranges::any_of(holeOf, [&](const float(&hole)[2]) {
            return std::hypot(middle[0] - hole[0], middle[2] - hole[1]) < holeRadius;
        });
    });
    cloth.vertices = waved(0);
}

std::vector<Eigen::Vector3f> TunnelScene::waved(float phase) const {
    std::vector<Eigen::Vector3f> moved = cloth.vertices;
    for (Eigen::Vector3f& vertex : moved) {
        vertex[1] = heightAt(vertex[0], vertex[2], phase);
    }
    return moved;
}

TunnelEvent TunnelScene::event(float speed, bool still, test::Random& random) const {
    const auto uniform = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    const float phase = still ? 0 : uniform(0, 6);
    const float phaseNow = still ? 0 : phase + 0.02F;
    Eigen::Vector3f aim;
    switch (random.bits() % 4) {
        case 0:  // just past the edge, on either side of it
            aim = {(random.bits() % 2 == 0 ? 1.0F : -1.0F) * (half + uniform(-0.008, 0.012)), 0, uniform(-half, half)};
            break;
        case 1: {  // through a hole or at its rim
            const float(&hole)[2] = holeOf[random.bits() % 4];
            aim = {hole[0] + uniform(-0.035, 0.035), 0, hole[1] + uniform(-0.035, 0.035)};
            break;
        }
        default:
            aim = {uniform(-half, half), 0, uniform(-half, half)};
    }
    aim[1] = heightAt(aim[0], aim[2], phase);
    Eigen::Vector3f way = random.direction();
    if (random.bits() % 2 == 0) {
        way = (way + Eigen::Vector3f(0, way[1] < 0 ? -2.0F : 2.0F, 0)).normalized();  // across rather than along
    }
    // Mostly point first.
    const Eigen::Vector3f axis = (way + uniform(0, 0.6) * random.direction()).normalized();
    const Eigen::Matrix3f rotation =
        Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitY(), axis).toRotationMatrix();
    // The point is there, more or less, at some time of the step.
    const Eigen::Vector3f start = aim - 0.05F * axis - (uniform(0, 1) * speed + 0.01F * uniform(0, 1)) * way;
    TunnelEvent result{waved(phase), waved(phaseNow), {}, {}};
    for (const Eigen::Vector3f& vertex : needle.vertices) {
        result.needleBefore.emplace_back(rotation * vertex + start);
        result.needleNow.emplace_back(result.needleBefore.back() + speed * way);
    }
    return result;
}

}  // namespace grapeshot::bench
