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

constexpr std::uint64_t hapticBudget = 500;  ///< work units of a step: about a tenth of a millisecond

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
        SceneMethod limited = budgeted(grapeshotMethod(runsOf(options)), hapticBudget);
        limited.name += " budgeted";
        std::vector<SceneMethod> methods{grapeshotMethod(runsOf(options)), limited, gimpactMethod()};
        for (SceneMethod& method : methods) {
            method.world.timeStep = 1e-3;
        }
        const std::vector<Outcome> outcomes = runInTurns(course, methods, [&](const scenes::WorldSettings& method) {
            return hapticPair(method, margin, triangles);
        });
        const std::vector<Quality> qualities = addRows("haptic_pair", atMargin(margin), outcomes, "gimpact", results);
        Claims claims(course.scenario, results);
        for (std::size_t i = 0; i < 2; ++i) {
            const std::string suffix = i == 0 ? "" : ", budgeted";
            claims.atMost("bodies lost" + suffix, qualities[i].lost, 0);
            claims.atMost("deepest true penetration / radius" + suffix, qualities[i].bodyDepth.max, 0.01);
        }
        claims.atMost("work of a step beyond max(budget, mandatory slices)", qualities[1].workBeyondBudget, 0);
        if (!options.quick) {
            const auto p99 = [&](std::size_t fromLast) {
                return results.rows[results.rows.size() - fromLast].timeUs.p99;
            };
            claims.atLeast("p99 of GImpact's narrowphase / p99 of ours", p99(1) / p99(3), 1);
            claims.atLeast("p99 of our narrowphase / the same, budgeted", p99(3) / p99(2), 1);
        }
    }
}

}  // namespace grapeshot::bench
