#include "scene_machines.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "machine_scenes.hpp"
#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

void runMachine(std::string_view name, const Options& options, report::Report& results) {
    const MachineScene& scene = *std::ranges::find(machineScenes(), name, &MachineScene::name);
    for (const double margin : sceneMargins) {
        Course course{.scenario = std::string(name) + ", " + atMargin(margin), .seconds = scene.seconds};
        if (options.quick) {
            course.seconds = 0.5;
        }
        const int runs = options.repetitions.value_or(1);
        const std::vector<SceneMethod> methods{grapeshotMethod(runs), gimpactMethod(),
                                               hacdMethod(runs, hullSettings(options))};
        const std::vector<Outcome> outcomes = runInTurns(
            course, methods, [&](const scenes::WorldSettings& method) { return scene.make(method, margin); });
        const std::vector<Quality> qualities =
            addRows(std::string(name), atMargin(margin), outcomes, "gimpact", results);
        for (std::size_t i = 0; i < outcomes.size(); ++i) {
            results.rows[results.rows.size() - outcomes.size() + i].measured.emplace_back(
                "faults", scene.faults(outcomes[i].recorder.world()));
        }
        Claims claims(course.scenario, results);
        claims.atMost("bodies lost", qualities.front().lost, 0);
        claims.atMost(std::string(scene.fault), scene.faults(outcomes.front().recorder.world()), 0);
        claims.atMost("p99 of true penetration / radius", qualities.front().bodyDepth.p99, 0.01);
        claims.atMost("energy over the initial, %", qualities.front().energyOverInitialPercent, 0.5);
    }
}

namespace {

scenes::World hapticPair(scenes::WorldSettings method, double margin, int triangles) {
    method.margin = margin;
    method.timeStep = 1e-3;
    method.sleeping = false;
    method.lower = Eigen::Vector3d::Constant(-5);
    method.upper = Eigen::Vector3d::Constant(5);
    scenes::World world(method);
    const int frequency = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles / 20.0))));
    world.addBody(world.addMesh(scenes::bumpySphere(1, 0.2F, 7, frequency, 77)), scenes::PoseD{}, 0);
    const std::size_t tool = world.addMesh(scenes::spikedBall(0.3F, 0.15F, 24, triangles));
    world.addBody(tool, {Eigen::Matrix3d::Identity(), {0.1, 1.75, 0.05}}, 1, {{0.5, -0.5, 0.2}, {1, 2, 0.5}});
    return world;
}

}  // namespace

void runHapticPair(const Options& options, report::Report& results) {
    for (const double margin : sceneMargins) {
        const Course course{.scenario = "haptic_pair, " + atMargin(margin),
                            .seconds = options.quick ? 0.05 : 1.0,
                            .frameSeconds = 0.01};
        const int triangles = options.quick ? 2000 : 20000;
        std::vector<SceneMethod> methods{grapeshotMethod(runsOf(options)), gimpactMethod()};
        for (SceneMethod& method : methods) {
            method.world.timeStep = 1e-3;
        }
        const std::vector<Outcome> outcomes = runInTurns(course, methods, [&](const scenes::WorldSettings& method) {
            return hapticPair(method, margin, triangles);
        });
        const std::vector<Quality> qualities = addRows("haptic_pair", atMargin(margin), outcomes, "gimpact", results);
        Claims claims(course.scenario, results);
        claims.atMost("bodies lost", qualities.front().lost, 0);
        claims.atMost("deepest true penetration / radius", qualities.front().bodyDepth.max, 0.01);
        if (!options.quick) {
            claims.atLeast(
                "p99 of GImpact's narrowphase / p99 of ours",
                results.rows[results.rows.size() - 1].timeUs.p99 / results.rows[results.rows.size() - 2].timeUs.p99,
                50);
        }
    }
}

}  // namespace grapeshot::bench
