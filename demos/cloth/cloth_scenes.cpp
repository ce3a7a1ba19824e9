#include "cloth_scenes.hpp"

#include <BulletSoftBody/btSoftBodyHelpers.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace grapeshot::cloth {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double margin = 0.02;  // m
const scenes::Colour red{0.80F, 0.32F, 0.28F};
const scenes::Colour stone{0.72F, 0.72F, 0.74F};
const scenes::Camera camera{.eye = {-2.8, 3.2, -4.2}, .target = {0, 0.7, 0}, .fieldOfView = 40};

void soften(btSoftBody& body) {
    body.setTotalMass(1);
    body.m_cfg.kDF = btScalar(0.8);
    body.m_cfg.kDP = btScalar(0.01);
    body.m_cfg.piterations = 5;
}

std::unique_ptr<btSoftBody> sheet(btSoftBodyWorldInfo& info, double half, double height, int nodes) {
    const auto h = static_cast<btScalar>(half);
    const auto y = static_cast<btScalar>(height);
    std::unique_ptr<btSoftBody> body(
        btSoftBodyHelpers::CreatePatch(info, {-h, y, -h}, {h, y, -h}, {-h, y, h}, {h, y, h}, nodes, nodes, 0, true));
    soften(*body);
    return body;
}

soft::Scene sheetOn(const char* name, const scenes::Mesh& mesh, const scenes::PoseD& pose, double height,
                    soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options) {
    soft::Scene scene;
    scene.name = name;
    scene.world = std::make_unique<soft::World>(method, options.seed);
    scene.camera = camera;
    scene.world->add(mesh, pose, false, stone);
    // Where the sheet slides off it lies on the ground.
    scene.world->add(scenes::grid(6, 6, 24, 24), {}, false, {0.86F, 0.85F, 0.82F});
    scene.world->add(sheet(scene.world->info(), 1.2, height, settings.nodes), margin, red, true);
    return scene;
}

/// Rotated about the y axis: radius of the body at a height between 0 and 2 m.
double waist(double y) {
    return 0.38 + 0.10 * std::cos(2 * std::numbers::pi * y / 1.1);
}

scenes::Mesh torso(int around, int along) {
    scenes::Mesh mesh;
    for (int i = 0; i <= along; ++i) {
        const double y = 2.0 * i / along;
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            const double radius = waist(y) * (1 + 0.08 * std::cos(3 * angle));
            mesh.vertices.push_back(Vector3d(radius * std::cos(angle), y, radius * std::sin(angle)).cast<float>());
        }
    }
    mesh.vertices.emplace_back(0, 0, 0);
    mesh.vertices.emplace_back(0, 2, 0);
    const auto n = static_cast<std::uint32_t>(around);
    const auto rows = static_cast<std::uint32_t>(along);
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t next = (k + 1) % n;
        for (std::uint32_t i = 0; i < rows; ++i) {
            mesh.triangles.push_back({i * n + k, (i + 1) * n + k, (i + 1) * n + next});
            mesh.triangles.push_back({i * n + k, (i + 1) * n + next, i * n + next});
        }
        mesh.triangles.push_back({(rows + 1) * n, k, next});
        mesh.triangles.push_back({(rows + 1) * n + 1, rows * n + next, rows * n + k});
    }
    return mesh;
}

/// A skirt from the upper waist down over the hips, so that it stays on.
std::unique_ptr<btSoftBody> dress(btSoftBodyWorldInfo& info, int around) {
    const double low = 0.35, high = 1.65;  // m
    const int rows = std::max(6, around / 2);
    std::vector<btVector3> points;
    for (int i = 0; i <= rows; ++i) {
        const double y = low + (high - low) * i / rows;
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            const double radius = 0.36 + 0.24 * std::min(1.0, (high - y) / 0.55);
            points.emplace_back(btScalar(radius * std::cos(angle)), btScalar(y), btScalar(radius * std::sin(angle)));
        }
    }
    auto body = std::make_unique<btSoftBody>(&info, static_cast<int>(points.size()), points.data(), nullptr);
    const auto at = [around](int i, int k) { return i * around + k % around; };
    for (int i = 0; i <= rows; ++i) {
        for (int k = 0; k < around; ++k) {
            body->appendLink(at(i, k), at(i, k + 1));
            if (i == rows) {
                // The hem at the top is elastic and was made for the narrowest place.
                btSoftBody::Link& link = body->m_links[body->m_links.size() - 1];
                link.m_rl *= btScalar(0.9);
                continue;
            }
            body->appendLink(at(i, k), at(i + 1, k));
            body->appendLink(at(i, k), at(i + 1, k + 1));
            // Against folds that are sharper than its cells.
            body->appendLink(at(i, k), at(i, k + 2));
            if (i + 2 <= rows) {
                body->appendLink(at(i, k), at(i + 2, k));
            }
            body->appendFace(at(i, k), at(i + 1, k), at(i + 1, k + 1));
            body->appendFace(at(i, k), at(i + 1, k + 1), at(i, k + 1));
        }
    }
    soften(*body);
    return body;
}

}  // namespace

soft::Scene overTorus(soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options) {
    scenes::PoseD pose;
    pose.translation = {0, 0.9, 0};
    return sheetOn("torus", scenes::torus(0.7F, 0.2F, 48, 24), pose, 1.3, method, settings, options);
}

soft::Scene overComb(soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options) {
    scenes::PoseD pose;  // the teeth up
    pose.rotation = Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitZ()).toRotationMatrix();
    pose.translation = {0, 0.9, 0};
    return sheetOn("comb", scenes::comb(7, 0.4F, 0.2F, 0.3F, 3), pose, 1.6, method, settings, options);
}

soft::Scene overBlades(soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options) {
    scenes::Mesh fan;
    for (int i = 0; i < 6; ++i) {
        scenes::Mesh blade = scenes::box({0.6F, 0.35F, 0.02F}, 6);
        const Eigen::AngleAxisf turn(static_cast<float>(std::numbers::pi) * static_cast<float>(i) / 6,
                                     Vector3f::UnitY());
        for (Vector3f& vertex : blade.vertices) {
            vertex = turn * Vector3f(vertex.x() + 0.72F, vertex.y(), vertex.z());
        }
        fan = i == 0 ? blade : scenes::merged(fan, blade);
    }
    scenes::PoseD pose;
    pose.translation = {0, 0.8, 0.66};
    return sheetOn("blades", fan, pose, 1.3, method, settings, options);
}

soft::Scene garment(soft::Method method, const ClothSettings& settings, const soft::DemoOptions& options) {
    soft::Scene scene;
    scene.name = "garment";
    scene.world = std::make_unique<soft::World>(method, options.seed);
    scene.camera = camera;
    soft::World& world = *scene.world;
    const std::size_t body = world.add(torso(36, 40), {}, true, stone);
    world.add(scenes::grid(6, 6, 24, 24), {Eigen::Matrix3d::Identity(), {0, -0.3, 0}}, false, {0.86F, 0.85F, 0.82F});
    soft::CarriedSettings carrying;
    carrying.thickness = 2 * margin;
    carrying.largestStep = 0.03;
    carrying.rounds = 20;
    carrying.contactPasses = 20;
    carrying.friction = 0.3;
    std::unique_ptr<btSoftBody> cloth = dress(world.info(), settings.nodes * 2);
    soft::CarriedSurface surface = soft::ownSurface(*cloth);
    SelfCollision itself;
    itself.thickness = static_cast<float>(2 * margin);
    world.add(std::make_unique<soft::CarriedBody>(world.info(), std::move(cloth), std::move(surface), carrying), itself,
              red);
    scene.beforeStep = [&world, body](int step) {
        const double t = soft::timeStep * (step + 1);
        const double begun = std::min(1.0, t / 2);  // from rest
        scenes::PoseD pose;
        pose.rotation = Eigen::AngleAxisd(0.6 * begun * std::sin(1.7 * t), Vector3d::UnitY()).toRotationMatrix() *
                        Eigen::AngleAxisd(0.15 * begun * std::sin(2.3 * t), Vector3d::UnitZ()).toRotationMatrix();
        pose.translation = {0.3 * begun * std::sin(1.1 * t), 0.1, 0};
        world.drive(body, pose);
    };
    return scene;
}

}  // namespace grapeshot::cloth
