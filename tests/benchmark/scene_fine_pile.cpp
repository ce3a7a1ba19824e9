#include "scene_fine_pile.hpp"

#include <iostream>

#include "pile_scene.hpp"
#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

namespace {

/// Poses and motion of the bodies; contacts of earlier steps are not taken over.
void copyMotion(const scenes::World& from, scenes::World& to) {
    for (std::size_t body = 0; body < from.bodies(); ++body) {
        if (!from.moving(body)) {
            continue;
        }
        const btRigidBody& source = from.body(body);
        btRigidBody& target = to.body(body);
        target.setCenterOfMassTransform(source.getCenterOfMassTransform());
        target.setLinearVelocity(source.getLinearVelocity());
        target.setAngularVelocity(source.getAngularVelocity());
        target.setInterpolationLinearVelocity(source.getLinearVelocity());
        target.setInterpolationAngularVelocity(source.getAngularVelocity());
    }
}

}  // namespace

void runFinePile(const Options& options, report::Report& results) {
    for (const double margin : sceneMargins) {
        PileSettings settings;
        settings.seed = options.seed;
        settings.margin = margin;
        settings.trianglesPerBody = 20000;
        double fall = 3;  // s; most have landed, few are at rest
        Course course{
            .scenario = "pile_20k, " + atMargin(margin), .seconds = 2.0 / 3, .frameSeconds = 1.0 / 12, .coldSteps = 1};
        if (options.quick) {
            settings.bodies = 9;
            settings.trianglesPerBody = 2000;
            fall = 0.8;
            course.seconds = 0.2;
        }
        std::cerr << course.scenario << ": until it has landed ...\n";
        const std::vector<SceneMethod> methods{grapeshotMethod(runsOf(options)), gimpactMethod()};
        scenes::World landed = makePile(methods.front().world, settings);
        for (double time = 0; time < fall; time += landed.settings().timeStep) {
            landed.step();
        }
        const std::vector<Outcome> outcomes = runInTurns(course, methods, [&](const scenes::WorldSettings& method) {
            scenes::World world = makePile(method, settings);
            copyMotion(landed, world);
            return world;
        });
        const std::vector<Quality> qualities = addRows("pile_20k", atMargin(margin), outcomes, "gimpact", results);
        Claims claims(course.scenario, results);
        claims.atMost("bodies lost", qualities.front().lost, 0);
        claims.atLeast("mean contacts of a step", meanContacts(outcomes.front().recorder.run()), settings.bodies / 4.0);
        if (!options.quick) {
            claims.atLeast("GImpact's narrowphase time / ours", narrowphaseRatio(outcomes[1], outcomes[0]), 100);
        }
    }
}

}  // namespace grapeshot::bench
