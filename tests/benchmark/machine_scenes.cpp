#include "machine_scenes.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

using namespace scenes;
using Eigen::Vector3d;

namespace {

constexpr double quarter = std::numbers::pi / 2;

Eigen::Matrix3d turned(double angle, const Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Vector3d centre(const World& world, std::size_t body) {
    const btVector3& p = world.body(body).getCenterOfMassPosition();
    return {p.x(), p.y(), p.z()};
}

WorldSettings settingsOf(WorldSettings method, double margin) {
    method.margin = margin;
    method.lower = Vector3d::Constant(-30);
    method.upper = Vector3d::Constant(30);
    return method;
}

// A chain of ten links, let go sideways from its first.

constexpr int links = 10;
constexpr double linkRadius = 1;  ///< of the middle line, m
constexpr double linkTube = 0.2;

World chain(WorldSettings method, double margin) {
    World world(settingsOf(std::move(method), margin));
    const std::size_t link = world.addMesh(torus(linkRadius, linkTube, 40, 16));
    for (int i = 0; i < links; ++i) {
        // The ring's plane holds the chain's direction, x.
        const Eigen::Matrix3d plane = turned(i % 2 == 0 ? 0 : quarter, Vector3d::UnitX());
        world.addBody(link, {plane, {1.5 * i, 12, 0}}, i == 0 ? 0 : 1);
    }
    return world;
}

int brokenLinks(const World& world) {
    int broken = 0;
    for (std::size_t i = 0; i + 1 < links; ++i) {
        // Linked, no two centres can be further apart.
        broken += (centre(world, i) - centre(world, i + 1)).norm() > 2 * (linkRadius - linkTube) ? 1 : 0;
    }
    return broken;
}

// Five cups dropped into each other.

constexpr int cups = 5;
constexpr float cupHeight = 1.4F;

/// Wider at the top, so that one goes into another.
Mesh taperedCup() {
    Mesh mesh = cup(0.8F, 0.12F, cupHeight, 40, 12);
    for (Eigen::Vector3f& v : mesh.vertices) {
        const float wider = 1 + 0.4F * v.y();
        v = {wider * v.x(), v.y(), wider * v.z()};
    }
    return mesh;
}

World nestedCups(WorldSettings method, double margin) {
    World world(settingsOf(std::move(method), margin));
    world.addMeshFloor(grid(6, 6, 12, 12));
    const std::size_t mesh = world.addMesh(taperedCup());
    for (int i = 0; i < cups; ++i) {
        const Vector3d start(0.01 * (i % 3), 0.85 + 0.9 * i, 0.01 * (i % 2));
        world.addBody(mesh, {turned(0.3 * i, Vector3d::UnitY()), start}, 1);
    }
    return world;
}

int unnestedCups(const World& world) {
    int wrong = 0;
    for (std::size_t i = 2; i < world.bodies(); ++i) {
        const Vector3d apart = centre(world, i) - centre(world, i - 1);
        // Above the one before, and within it.
        wrong += apart.y() > 0.1 && apart.norm() < cupHeight ? 0 : 1;
    }
    return wrong;
}

// Two gears on fixed axles; the first is set spinning and drives the second.

constexpr float gearRadius = 3;
constexpr float toothHeight = 0.8F;
constexpr float axleRadius = 0.6F;
constexpr int gearTeeth = 10;

World gears(WorldSettings method, double margin) {
    method.gravity = Vector3d::Zero();
    method.friction = 0.1;
    method.sleeping = false;
    World world(settingsOf(std::move(method), margin));
    const std::size_t wheel = world.addMesh(gear(gearRadius, toothHeight, axleRadius + 0.15F, 1, gearTeeth, 3));
    const std::size_t axle = world.addMesh(threadedRod({axleRadius, 0, 1}, 3, 40, 6));
    const double distance = 2 * gearRadius - 0.5 * toothHeight;
    world.addBody(axle, PoseD{}, 0);
    world.addBody(axle, {Eigen::Matrix3d::Identity(), {distance, 0, 0}}, 0);
    // Half a tooth against each other where they meet.
    const double pitch = 2 * std::numbers::pi / gearTeeth;
    world.addBody(wheel, {turned(-0.375 * pitch, Vector3d::UnitY()), Vector3d::Zero()}, 1, {{}, {0, 3, 0}});
    world.addBody(wheel, {turned(std::numbers::pi + 0.125 * pitch, Vector3d::UnitY()), {distance, 0, 0}}, 1);
    return world;
}

int gearsThatDoNotMesh(const World& world) {
    const double driver = world.body(2).getAngularVelocity().y();
    const double driven = world.body(3).getAngularVelocity().y();
    const bool opposite = driver * driven < 0;
    const bool alike = std::abs(driver + driven) < 0.5 * (std::abs(driver) + std::abs(driven));
    return (opposite ? 0 : 1) + (alike ? 0 : 1);
}

// Half a circle of wedge-shaped stones, held by nothing but each other.

constexpr int stones = 9;
constexpr double innerRadius = 2;
constexpr double outerRadius = 3;

World arch(WorldSettings method, double margin) {
    method.friction = 0.9;
    method.solverIterations = 100;
    World world(settingsOf(std::move(method), margin));
    world.addBox({6, 0.5, 3}, {Eigen::Matrix3d::Identity(), {0, -0.5, 0}}, 0);
    const double angle = std::numbers::pi / stones;
    const std::size_t stone = world.addMesh(voussoir(innerRadius, outerRadius, static_cast<float>(angle), 1.5F, 2));
    // Outwards by as much as leaves both margins between neighbours.
    const double apart = margin / std::sin(0.5 * angle);
    for (int i = 0; i < stones; ++i) {
        const double at = (i + 0.5) * angle - quarter;
        const Eigen::Matrix3d turn = turned(-at, Vector3d::UnitZ());
        world.addBody(stone, {turn, turn * Vector3d(0, apart, 0)}, 1);
    }
    return world;
}

int fallenStones(const World& world) {
    int fallen = 0;
    for (std::size_t i = 1; i < world.bodies(); ++i) {
        fallen += centre(world, i).norm() > innerRadius ? 0 : 1;
    }
    return fallen;
}

constexpr std::array scenes{
    MachineScene{"chain", 10, chain, "links come apart", brokenLinks},
    MachineScene{"stacked_cups", 10, nestedCups, "cups not in the one below", unnestedCups},
    MachineScene{"gears", 5, gears, "gears that do not drive each other", gearsThatDoNotMesh},
    MachineScene{"arch", 10, arch, "stones fallen", fallenStones},
};

}  // namespace

std::span<const MachineScene> machineScenes() {
    return scenes;
}

World makeHapticPair(WorldSettings method, double margin, int triangles) {
    method.margin = margin;
    method.timeStep = hapticTimeStep;
    method.sleeping = false;
    method.lower = Vector3d::Constant(-5);
    method.upper = Vector3d::Constant(5);
    World world(method);
    const int frequency = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles / 20.0))));
    world.addBody(world.addMesh(bumpySphere(1, 0.2F, 7, frequency, 77)), PoseD{}, 0);
    const std::size_t tool = world.addMesh(spikedBall(0.3F, 0.15F, 24, triangles));
    world.addBody(tool, {Eigen::Matrix3d::Identity(), {0.1, 1.75, 0.05}}, 1, {{0.5, -0.5, 0.2}, {1, 2, 0.5}});
    return world;
}

}  // namespace grapeshot::bench
