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

}  // namespace

void runHapticPair(const Options& options, report::Report& results) {
    for (const double margin : sceneMargins) {
        const Course course{.scenario = "haptic_pair, " + atMargin(margin),
                            .seconds = options.quick ? 0.05 : 1.0,
                            .frameSeconds = 0.01};
        const int triangles = hapticTriangles(options.quick);
        SceneMethod limited = budgeted(grapeshotMethod(runsOf(options)), hapticBudget);
        limited.name += " budgeted";
        std::vector<SceneMethod> methods{grapeshotMethod(runsOf(options)), limited, gimpactMethod()};
        for (SceneMethod& method : methods) {
            method.world.timeStep = hapticTimeStep;
        }
        const std::vector<Outcome> outcomes = runInTurns(course, methods, [&](const scenes::WorldSettings& method) {
            return makeHapticPair(method, margin, triangles);
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
