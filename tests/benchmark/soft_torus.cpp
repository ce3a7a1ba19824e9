#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scene_rows.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"
#include "support/sheet_oracle.hpp"

namespace grapeshot::bench {

namespace {

constexpr double tubeShare = 0.3;  // of the ring's radius

scenes::Mesh torusOf(double ring) {
    return scenes::torus(static_cast<float>(ring), static_cast<float>(tubeShare * ring), 48, 24);
}

std::unique_ptr<SoftWorld> makeCloth(const SoftMethod& method, double ring, double margin, int cells) {
    auto world = std::make_unique<SoftWorld>(method);
    world->addMesh(torusOf(ring), 0.005 * ring);
    const auto half = static_cast<float>(1.3 * ring);
    btSoftBody& cloth = world->addSoft(
        scenes::moved(scenes::grid(half, half, cells, cells), {0, static_cast<float>(0.6 * ring), 0}), 1, margin);
    cloth.m_cfg.kDF = 1;
    cloth.m_cfg.piterations = 5;
    return world;
}

/// The torus by its formula: its mesh is a polygon in it, at most 1 % of the tube inside.
report::NamedNumbers judgeCloth(const SoftWorld& world, double ring) {
    const std::vector<Eigen::Vector3d> nodes = world.positions(0);
    int inside = 0;
    double highest = -1e9;
    for (const Eigen::Vector3d& x : nodes) {
        const double radial = std::hypot(x.x(), x.z()) - ring;
        inside += std::hypot(radial, x.y()) < 0.99 * tubeShare * ring ? 1 : 0;
        highest = std::max(highest, x.y() / ring);
    }
    std::vector<Eigen::Vector3d> vertices;
    for (const Eigen::Vector3f& v : torusOf(ring).vertices) {
        vertices.push_back(v.cast<double>());
    }
    const int through = test::pointsAbove({nodes, world.mesh(0).triangles}, vertices);
    return {{"inside", inside}, {"highest", highest}, {"rigidThrough", through}};
}

}  // namespace

void runClothOnTorus(double ring, const Options& options, report::Report& results) {
    std::string radius = std::to_string(ring);
    radius.resize(3);
    const SoftCourse course{.scenario = "cloth on torus " + radius + " m",
                            .mesh = "torus",
                            .steps = options.quick ? 60 : 1200,
                            .limitSeconds = 30};
    const std::vector<SoftOutcome> outcomes = runSoft(
        course, softMethods(), [&](const SoftMethod& method) { return makeCloth(method, ring, 0.04 * ring, 20); });
    const auto judge = [&](const SoftWorld& world) { return judgeCloth(world, ring); };
    addSoftRows(course, outcomes, judge, results);
    const report::NamedNumbers judged = judge(*outcomes[0].world);
    Claims claims("soft " + course.scenario, results);
    claims.atMost("nodes inside", judged[0].second, 0);
    claims.atLeast("highest node, radii of the ring", judged[1].second, tubeShare);
    claims.atMost("corners of the mesh through the cloth", judged[2].second, 0);
}

}  // namespace grapeshot::bench
