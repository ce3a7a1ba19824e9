#include <cmath>
#include <string>
#include <vector>

#include "scene_rows.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"
#include "support/depth_oracle.hpp"

namespace grapeshot::bench {

namespace {

constexpr double radius = 0.5;  // m

scenes::Mesh ball(const Eigen::Vector3f& centre, int triangles) {
    const int frequency = static_cast<int>(std::lround(std::sqrt(triangles / 20.0)));
    return scenes::moved(scenes::sphere(radius, frequency), centre);
}

std::unique_ptr<SoftWorld> makeBalls(const SoftMethod& method, int triangles, double margin) {
    auto world = std::make_unique<SoftWorld>(method);
    const auto gap = static_cast<float>(2 * radius + 2 * margin);
    world->addSoft(ball({0, 0, 0}, triangles), 1, margin);
    world->addSoft(ball({0.07F, gap, 0.03F}, triangles), 1, margin);
    for (std::size_t i = 0; i < 2; ++i) {
        btSoftBody& body = world->soft(i);
        body.m_cfg.kPR = 20;
        body.m_cfg.kDP = btScalar(0.01);
        const btScalar speed(i == 0 ? 1 : -1);
        body.setVelocity({0, speed, 0});
    }
    world->setGravity(0);
    return world;
}

/// Of both: nodes inside of the other. At most so many of each are asked, evenly spread: the oracle looks at every
/// triangle.
report::NamedNumbers judgeBalls(const SoftWorld& world) {
    constexpr std::size_t mostAsked = 2000;
    int inside = 0;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const std::vector<Eigen::Vector3d> nodes = world.positions(i);
        const std::vector<Eigen::Vector3d> other = world.positions(1 - i);
        const std::size_t stride = (nodes.size() + mostAsked - 1) / mostAsked;
        for (std::size_t k = 0; k < nodes.size(); k += stride) {
            inside += test::isInside(other, world.mesh(1 - i).triangles, nodes[k]) ? 1 : 0;
            ++asked;
        }
    }
    return {{"behind", inside}, {"nodes", static_cast<double>(asked)}};
}

}  // namespace

void runBalls(int triangles, const Options& options, report::Report& results) {
    if (options.quick) {
        triangles = 320;
    }
    for (const double margin : sceneMargins) {
        const SoftCourse course{.scenario = "balls " + atMargin(margin),
                                .mesh = "ball",
                                .steps = options.quick                   ? 20
                                         : triangles < softGateTriangles ? 60
                                                                         : gateSteps,
                                .limitSeconds = 30};
        const std::vector<SoftOutcome> outcomes = runSoft(
            course, softMethods(), [&](const SoftMethod& method) { return makeBalls(method, triangles, margin); });
        addSoftRows(course, outcomes, judgeBalls, results);
        Claims claims("soft " + course.scenario + ", " + std::to_string(triangles) + " triangles", results);
        claims.atMost("nodes inside the other ball", judgeBalls(*outcomes[0].world)[0].second, 0);
        if (triangles == softGateTriangles) {
            claims.atLeast("whole step, times as fast as Bullet's own",
                           softRatio(outcomes[1], outcomes[0], &SoftStep::wholeUs), softGateRatio);
        }
    }
}

}  // namespace grapeshot::bench
