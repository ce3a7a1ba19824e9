#include "scene_rest.hpp"

#include <string>

#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

namespace {

/// Of our residual speed in GImpact's.
double largestShare(test::RestScene scene) {
    return scene == test::RestScene::crossInHole || scene == test::RestScene::interlockedTori ? 0.2 : 0.1;
}

}  // namespace

void runRest(test::RestScene scene, const Options& options, report::Report& results) {
    const std::string label(name(scene));
    for (const double margin : sceneMargins) {
        const Course course{.scenario = label + ", " + atMargin(margin),
                            .seconds = options.quick ? 2.0 : 20.0,
                            .frameSeconds = 0.5,
                            .restSeconds = options.quick ? 0.5 : 15.0};
        const std::vector<SceneMethod> methods{grapeshotMethod(options.repetitions.value_or(1)), gimpactMethod()};
        const std::vector<Outcome> outcomes = runInTurns(course, methods, [&](const scenes::WorldSettings& method) {
            scenes::WorldSettings settings = test::undamped(method.engine, margin);
            settings.settings = method.settings;
            settings.standIn = method.standIn;
            settings.timeStep = method.timeStep;
            scenes::World world(settings);
            addRestScene(world, scene);
            return world;
        });
        const std::vector<Quality> qualities = addRows(label, atMargin(margin), outcomes, "gimpact", results);
        Claims claims(course.scenario, results);
        claims.atMost("bodies lost", qualities.front().lost, 0);
        claims.atMost("deepest true penetration / radius", qualities.front().bodyDepth.max, 0.02);
        if (!options.quick) {
            claims.atMost("residual RMS speed / GImpact's", qualities[0].residualSpeed / qualities[1].residualSpeed,
                          largestShare(scene));
        }
    }
}

}  // namespace grapeshot::bench
