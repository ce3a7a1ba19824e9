#include "stochastic_scenes.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include <support/poses.hpp>

namespace grapeshot::bench {

namespace {

using Eigen::Vector3f;

constexpr float start = 2.05F;  ///< distance of the middles in step 0, m: the boxes' spheres do not meet yet

/// Deformations move a vertex by at most about 0.015 m a step.
Vector3f breathing(const Vector3f& rest, float step) {
    const float r = rest.norm();
    return rest * (1 + 0.06F * std::sin(0.2F * step + 9 * rest.x()) * r);
}

Vector3f waving(const Vector3f& rest, float step) {
    return rest + Vector3f(0, 0.05F * std::sin(0.25F * step + 7 * rest.x()) * std::cos(4 * rest.z()), 0);
}

Vector3f writhing(const Vector3f& rest, float step) {
    return rest + 0.08F * Vector3f(std::sin(0.15F * step + 3 * rest.y()), std::sin(0.15F * step + 3 * rest.z()),
                                   std::sin(0.15F * step + 3 * rest.x()));
}

Vector3f bending(const Vector3f& rest, float step) {
    return rest + Vector3f(0, 0.1F * std::sin(0.12F * step) * rest.x() * rest.x(), 0);
}

scenes::Mesh fitted(scenes::Mesh mesh) {
    return scenes::normalised(std::move(mesh));
}

void setPlaced(const scenes::Mesh& mesh, Deformation deform, float step, const Eigen::Matrix3f& rotation,
               const Vector3f& translation, std::vector<Vector3f>& placed) {
    placed.reserve(mesh.vertices.size());
    for (const Vector3f& vertex : mesh.vertices) {
        placed.push_back(rotation * (deform != nullptr ? deform(vertex, step) : vertex) + translation);
    }
}

}  // namespace

Placement place(const ApproachScene& scene, std::uint64_t episode, int step) {
    test::Random random(episode);
    const Eigen::Matrix3f attitudeA = random.rotation();
    const Eigen::Matrix3f attitudeB = random.rotation();
    const Vector3f direction = random.direction();
    const Vector3f axis = random.direction();
    const auto t = static_cast<float>(step);
    const Eigen::Matrix3f turned = Eigen::AngleAxisf(scene.spin * t, axis).toRotationMatrix() * attitudeB;
    Placement placement;
    setPlaced(scene.a, scene.deformA, t, attitudeA, Vector3f::Zero(), placement.a);
    setPlaced(scene.b, scene.deformB, t, turned, (start - scene.speed * t) * direction, placement.b);
    return placement;
}

int lastStep(const ApproachScene& scene) {
    return static_cast<int>(start / scene.speed);
}

std::vector<ApproachScene> reportedApproaches() {
    const scenes::Mesh bumpy = fitted(scenes::bumpySphere(1.0F, 0.22F, 9, 12, 6151));
    const scenes::Mesh knot = fitted(scenes::torusKnot(2, 5, 1.0F, 0.35F, 0.16F, 300, 12));
    std::vector<ApproachScene> scenes;
    scenes.push_back({"bumpyBalls", bumpy, bumpy, 0.01F, 0.005F});
    scenes.push_back({"gearOnKnot", fitted(scenes::torusKnot(3, 5, 1.0F, 0.42F, 0.13F, 230, 12)),
                      fitted(scenes::gear(1.0F, 0.14F, 0.31F, 0.37F, 19, 2)), 0.01F, 0.0175F});
    scenes.push_back({"spikesInCup", fitted(scenes::cup(0.7F, 0.09F, 1.3F, 44, 14)),
                      fitted(scenes::spikedBall(1.0F, 0.38F, 46, 6'000)), 0.01F, 0.005F, nullptr, breathing});
    scenes.push_back({"clothOnRings", fitted(scenes::chainShot(1.0F, 0.22F, 48, 24)),
                      fitted(scenes::grid(1.0F, 1.0F, 48, 48)), 0.01F, 0.005F, nullptr, waving});
    scenes.push_back({"writhingKnots", knot, knot, 0.01F, 0.005F, writhing, writhing});
    return scenes;
}

std::vector<ApproachScene> fittingApproaches() {
    const scenes::Mesh trefoil = fitted(scenes::torusKnot(2, 3, 1.0F, 0.4F, 0.2F, 240, 12));
    std::vector<ApproachScene> scenes;
    scenes.push_back({"trefoils", trefoil, trefoil, 0.01F, 0.01F, bending, nullptr});
    scenes.push_back({"ballOnComb", fitted(scenes::comb(9, 0.6F, 0.16F, 0.09F, 3)),
                      fitted(scenes::bumpySphere(1.0F, 0.35F, 5, 14, 77)), 0.01F, 0.01F});
    scenes.push_back({"spikesOnBlock", fitted(scenes::crenelBlock({1.0F, 0.5F, 0.4F}, 5, 6)),
                      fitted(scenes::spikedBall(1.0F, 0.6F, 20, 5'000)), 0.01F, 0.005F, nullptr, bending});
    scenes.push_back(
        {"combOnTrefoil", trefoil, fitted(scenes::comb(12, 0.8F, 0.12F, 0.2F, 3)), 0.01F, 0.005F, writhing, nullptr});
    return scenes;
}

}  // namespace grapeshot::bench
