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

constexpr double half = 1;  // of the held sheet, m

scenes::Mesh sheet(double size, double height, int triangles) {
    const int cells = static_cast<int>(std::lround(std::sqrt(triangles / 2.0)));
    const auto edge = static_cast<float>(size);
    // Off the middle, so that no node lies above another.
    return scenes::moved(scenes::grid(edge, edge, cells, cells),
                         {static_cast<float>(0.0317 * height), static_cast<float>(height), 0});
}

std::unique_ptr<SoftWorld> makeSheets(const SoftMethod& method, int triangles, double margin) {
    auto world = std::make_unique<SoftWorld>(method);
    btSoftBody& held = world->addSoft(sheet(half, 0, triangles), 1, margin);
    for (int i = 0; i < held.m_nodes.size(); ++i) {
        const btVector3& x = held.m_nodes[i].m_x;
        if (std::max(std::abs(x.x()), std::abs(x.z())) > btScalar(0.999 * half)) {
            held.setMass(i, 0);
        }
    }
    // Thrown, because the held one gives way as fast as anything falls.
    world->addSoft(sheet(0.7 * half, 2.2 * margin, triangles), 0.5, margin).setVelocity({0, -1, 0});
    return world;
}

/// Nodes of each sheet on the wrong side of the other.
report::NamedNumbers judgeSheets(const SoftWorld& world) {
    const std::vector<Eigen::Vector3d> lower = world.positions(0);
    const std::vector<Eigen::Vector3d> upper = world.positions(1);
    const int below = test::pointsBelow({lower, world.mesh(0).triangles}, upper);
    const int above = test::pointsAbove({upper, world.mesh(1).triangles}, lower);
    return {{"behind", static_cast<double>(below + above)},
            {"nodes", static_cast<double>(lower.size() + upper.size())}};
}

}  // namespace

void runSheets(int triangles, const Options& options, report::Report& results) {
    if (options.quick) {
        triangles = 288;
    }
    for (const double margin : sceneMargins) {
        const SoftCourse course{.scenario = "sheets " + atMargin(margin),
                                .mesh = "sheet",
                                .steps = options.quick                   ? 30
                                         : triangles < softGateTriangles ? 60
                                                                         : gateSteps,
                                .limitSeconds = 30};
        const std::vector<SoftOutcome> outcomes = runSoft(
            course, softMethods(), [&](const SoftMethod& method) { return makeSheets(method, triangles, margin); });
        addSoftRows(course, outcomes, judgeSheets, results);
        const SoftOutcome& ours = outcomes[0];
        const SoftOutcome& bullet = outcomes[1];
        Claims claims("soft " + course.scenario + ", " + std::to_string(triangles) + " triangles", results);
        claims.atMost("nodes behind the other sheet", judgeSheets(*ours.world)[0].second, 0);
        if (triangles == softGateTriangles) {
            claims.atLeast("whole step, times as fast as Bullet's own", softRatio(bullet, ours, &SoftStep::wholeUs),
                           softGateRatio);
        }
    }
}

}  // namespace grapeshot::bench
