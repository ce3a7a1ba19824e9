#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene_rows.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"
#include "support/sheet_oracle.hpp"

namespace grapeshot::bench {

namespace {

constexpr double half = 0.8;          // m
constexpr double foldRadius = 0.125;  // m
constexpr int sharpTriangles = 512;
constexpr int bulletClusters = 64;

/// Where a point of the flat cloth is at the start.
Eigen::Vector3d folded(const Eigen::Vector3d& flat, bool sharply) {
    const double x = flat.x();
    if (sharply) {
        return {x > 0.05 ? -x : x, x > 0.05 ? 0.3 : x > -0.05 ? 0.15 : 0.05, flat.z()};
    }
    const double bend = foldRadius * std::numbers::pi / 2;  // half of the arc
    if (std::abs(x) >= bend) {
        return {bend - std::abs(x), x > 0 ? 0.05 + 2 * foldRadius : 0.05, flat.z()};
    }
    return {foldRadius * std::cos(x / foldRadius), 0.05 + foldRadius * (1 + std::sin(x / foldRadius)), flat.z()};
}

std::unique_ptr<SoftWorld> makeFold(const SoftMethod& method, int triangles, double margin) {
    auto world = std::make_unique<SoftWorld>(method);
    world->addGround();
    const int cells = static_cast<int>(std::lround(std::sqrt(triangles / 2.0)));
    const auto edge = static_cast<float>(half);
    btSoftBody& cloth = world->addSoft(scenes::grid(edge, edge, cells, cells), 1, margin);
    cloth.m_cfg.piterations = 5;
    for (int i = 0; i < cloth.m_nodes.size(); ++i) {
        btSoftBody::Node& node = cloth.m_nodes[i];
        const Eigen::Vector3d place = folded({node.m_x.x(), node.m_x.y(), node.m_x.z()}, triangles == sharpTriangles);
        node.m_x = {btScalar(place.x()), btScalar(place.y()), btScalar(place.z())};
        node.m_q = node.m_x;
    }
    world->collideWithItself(cloth);
    return world;
}

/// Nodes of the upper half that have any triangle of the lower half above them.
report::NamedNumbers judgeFold(const SoftWorld& world) {
    const std::vector<Eigen::Vector3d> nodes = world.positions(0);
    const scenes::Mesh& flat = world.mesh(0);
    std::vector<Triangle> lower;
    for (const Triangle& t : flat.triangles) {
        if (std::ranges::all_of(t, [&](std::uint32_t i) { return flat.vertices[i].x() < -1e-4F; })) {
            lower.push_back(t);
        }
    }
    const test::VerticalOracle sheet(nodes, lower);
    int below = 0;
    int upper = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (flat.vertices[i].x() > 1e-4F) {
            ++upper;
            below += sheet.at(nodes[i]).above > 0 ? 1 : 0;
        }
    }
    return {{"behind", below}, {"nodes", upper}};
}

}  // namespace

void runFold(int triangles, const Options& options, report::Report& results) {
    if (options.quick) {
        triangles = sharpTriangles;
    }
    std::vector<SoftMethod> methods = softMethods();
    methods.push_back({.name = "bulletClusters", .engine = scenes::Engine::none, .clusters = bulletClusters});
    const SoftCourse course{.scenario = "fold " + atMargin(sceneMargins[0]),
                            .mesh = "sheet",
                            .steps = options.quick                 ? 90
                                     : triangles == sharpTriangles ? 600
                                                                   : 120,
                            .limitSeconds = 30};
    const std::vector<SoftOutcome> outcomes = runSoft(
        course, methods, [&](const SoftMethod& method) { return makeFold(method, triangles, sceneMargins[0]); });
    addSoftRows(course, outcomes, judgeFold, results);
    Claims claims("soft " + course.scenario + ", " + std::to_string(triangles) + " triangles", results);
    claims.atMost("nodes below their own sheet", judgeFold(*outcomes[0].world)[0].second, 1);
    claims.atLeast("of Bullet's, so that the scene is one", judgeFold(*outcomes[1].world)[0].second, 10);
}

}  // namespace grapeshot::bench
