#include "scene_pile.hpp"

#include <algorithm>
#include <string>

#include "pile_scene.hpp"
#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

namespace {

struct PileCase {
    std::string scenario;
    PileSettings settings;
    double seconds = 12;
};

/// Ours, GImpact, compounds of hulls, hulls: in this order.
struct PileOutcome {
    std::vector<Outcome> outcomes;
    std::vector<Quality> qualities;
};

PileOutcome runCase(PileCase pile, double margin, const Options& options, report::Report& results) {
    pile.settings.seed = options.seed;
    pile.settings.margin = margin;
    if (options.quick) {
        pile.settings.bodies = std::min(pile.settings.bodies, 10);
        pile.settings.trianglesPerBody = std::min(pile.settings.trianglesPerBody, 1200);
        pile.seconds = 1;
    }
    const Course course{.scenario = pile.scenario + ", " + atMargin(margin), .seconds = pile.seconds};
    const int runs = runsOf(options);
    const std::vector<SceneMethod> methods{grapeshotMethod(runs), gimpactMethod(),
                                           hacdMethod(runs, hullSettings(options)), hullMethod(runs)};
    PileOutcome result;
    result.outcomes = runInTurns(course, methods,
                                 [&](const scenes::WorldSettings& method) { return makePile(method, pile.settings); });
    result.qualities = addRows(pile.scenario, atMargin(margin), result.outcomes, "gimpact", results);
    const Quality& ours = result.qualities.front();
    Claims claims(course.scenario, results);
    claims.atMost("bodies lost", ours.lost, 0);
    claims.atMost("p99 of true penetration / radius", ours.bodyDepth.p99, 0.01);
    claims.atMost("replays that differ in a bit", result.outcomes.front().differing, 0);
    claims.atLeast("mean contacts of a step", meanContacts(result.outcomes.front().recorder.run()),
                   pile.settings.bodies / 4.0);
    return result;
}

double stepUs(const Outcome& outcome) {
    return awakeMeanUs(outcome.recorder.run(), outcome.recorder.run().stepUs);
}

}  // namespace

void runPile(const Options& options, report::Report& results) {
    for (const double margin : sceneMargins) {
        const PileOutcome pile = runCase({.scenario = "pile", .settings = {}}, margin, options, results);
        if (options.quick) {
            continue;  // no times, and nothing has come to rest
        }
        const std::vector<Outcome>& outcomes = pile.outcomes;
        const Quality& ours = pile.qualities.front();
        const Quality& hulls = pile.qualities[2];
        Claims claims("pile, " + atMargin(margin), results);
        claims.atMost("rise of the energy, % of the initial", ours.energyRisePercent, 0.5);
        claims.atMost("seconds until all sleep", ours.secondsToSleep, 10);
        claims.atLeast("GImpact's narrowphase time / ours", narrowphaseRatio(outcomes[1], outcomes[0]), 50);
        claims.atMost("time of our step / of HACD's", stepUs(outcomes[0]) / stepUs(outcomes[2]), 1.5);
        claims.atMost("p99 of true penetration - HACD's / 5", ours.bodyDepth.p99 - hulls.bodyDepth.p99 / 5, 0);
    }
}

void runBoxFloorPile(const Options& options, report::Report& results) {
    runCase({.scenario = "pile_box", .settings = {.floor = PileFloor::box}}, sceneMargins[0], options, results);
}

void runSmallPile(const Options& options, report::Report& results) {
    runCase({.scenario = "pile10", .settings = {.bodies = 10}}, sceneMargins[0], options, results);
}

void runCoarsePile(const Options& options, report::Report& results) {
    runCase({.scenario = "pile_1k", .settings = {.trianglesPerBody = 1000}}, sceneMargins[0], options, results);
}

void runLargePile(const Options& options, report::Report& results) {
    runCase({.scenario = "pile200", .settings = {.bodies = 200}, .seconds = 5}, sceneMargins[0], options, results);
}

}  // namespace grapeshot::bench
