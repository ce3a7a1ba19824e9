#include "scene_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <stdexcept>

#include <support/rest_scenes.hpp>

#include "pile_scene.hpp"
#include "scene_methods.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

using scenes::Engine;
using scenes::World;

namespace {

double total(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Both engines step by step in turns, ours then replayed; adds rows and claims.
void runPile(const Options& options, report::Report& results) {
    PileSettings settings;
    settings.seed = options.seed;
    int steps = 240;
    if (options.quick) {
        settings.bodies = 12;
        settings.trianglesPerBody = 1200;
        steps = 100;
    }
    constexpr int frameEvery = 4;
    Recorder gimpact(makePile(Engine::gimpact, settings), frameEvery);
    Recorder ours(makePile(Engine::grapeshot, settings), frameEvery);
    for (int i = 0; i < steps; ++i) {
        gimpact.step();
        ours.step();
        if (i % 20 == 19) {
            std::cerr << "pile: step " << i + 1 << " of " << steps << '\n';
        }
    }
    Run best = ours.run();
    double differing = 0;
    const int repetitions = options.repetitions.value_or(options.quick ? 2 : 3);
    std::vector<double> totals{total(best.narrowphaseUs)};
    for (int repetition = 1; repetition < repetitions; ++repetition) {
        Recorder replay(makePile(Engine::grapeshot, settings), frameEvery);
        for (int i = 0; i < steps; ++i) {
            replay.step();
        }
        totals.push_back(total(replay.run().narrowphaseUs));
        differing += mergeReplay(best, replay.run()) ? 0 : 1;
    }

    const double ratio = total(gimpact.run().narrowphaseUs) / total(best.narrowphaseUs);
    const auto addRow = [&](const World& world, const Run& run) -> report::Row& {
        report::Row row = summary("pile", "mixed", world, run);
        const Depths depths = depthsOf(world, run.frames);
        const report::Quantiles pairs = report::quantiles(depths.pairs);
        const report::Quantiles frames = report::quantiles(depths.deepest);
        row.measured.insert(row.measured.end(), {{"depthP99", pairs.p99 / pileRadius},
                                                 {"depthMax", pairs.max / pileRadius},
                                                 {"stepDeepestP50", frames.p50 / pileRadius},
                                                 {"pairsJudged", static_cast<double>(depths.pairs.size())}});
        results.rows.push_back(row);
        return results.rows.back();
    };
    addRow(gimpact.world(), gimpact.run());
    report::Row& row = addRow(ours.world(), best);
    row.peer = "gimpact";
    row.ratio = ratio;
    row.measured.insert(row.measured.end(),
                        {{"replaySpread", report::spread(totals)}, {"replaysDiffering", differing}});
    const double depthP99 = std::ranges::find(row.measured, "depthP99", [](const auto& m) { return m.first; })->second;

    results.claims.push_back({"pile: bodies lost", static_cast<double>(best.steps.back().lost), false, 0});
    results.claims.push_back({"pile: p99 of true penetration / radius", depthP99, false, 0.02});
    results.claims.push_back({"pile: replays that differ in a bit", differing, false, 0});
    results.claims.push_back(
        {"pile: mean contacts of a step", row.work.front().second, true, static_cast<double>(settings.bodies) / 4});
    if (!options.quick) {
        results.claims.push_back({"pile: GImpact's narrowphase time / ours", ratio, true, 20});
    }
}

/// How much a body still moves when it should be at rest.
void runRest(test::RestScene scene, const Options& options, report::Report& results) {
    const double seconds = options.quick ? 4 : 20;
    const double watched = options.quick ? 1 : 15;
    const std::string label(name(scene));
    std::cerr << label << " ...\n";
    const auto make = [&](Engine engine) {
        World world(test::undamped(engine, 0.02));
        addRestScene(world, scene);
        return Recorder(std::move(world), 30);
    };
    Recorder gimpact = make(Engine::gimpact);
    Recorder ours = make(Engine::grapeshot);
    const double timeStep = ours.world().settings().timeStep;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / timeStep)); ++i) {
        gimpact.step();
        ours.step();
    }
    std::array<double, 2> residuals{};
    double ourDepth = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        Recorder& recorder = i == 0 ? gimpact : ours;
        report::Row row = summary(label, label, recorder.world(), recorder.run());
        residuals[i] = residualSpeed(recorder.run(), watched, timeStep);
        const double depth = report::quantiles(depthsOf(recorder.world(), recorder.run().frames).deepest).max;
        row.measured.insert(row.measured.end(), {{"residualRmsSpeed", residuals[i]}, {"depthMax", depth}});
        if (i == 1) {
            row.peer = "gimpact";
            row.ratio = total(gimpact.run().narrowphaseUs) / total(ours.run().narrowphaseUs);
            ourDepth = depth;
        }
        results.rows.push_back(row);
    }
    results.claims.push_back({label + ": bodies lost", static_cast<double>(ours.run().steps.back().lost), false, 0});
    results.claims.push_back({label + ": deepest true penetration, m", ourDepth, false, 0.02});
    if (!options.quick) {
        results.claims.push_back(
            {label + ": residual RMS speed / GImpact's", residuals[1] / residuals[0], false, 0.25});
    }
}

}  // namespace

report::Report runSceneSuite(const Options& options) {
    constexpr std::array rests{test::RestScene::uOnBar, test::RestScene::crossInHole, test::RestScene::interlockedTori};
    std::vector<std::string> wanted = options.scenarios;
    if (wanted.empty()) {
        wanted = {"pile"};
        for (const test::RestScene scene : rests) {
            wanted.emplace_back(name(scene));
        }
        wanted.emplace_back("methods");
    }
    report::Report results{.suite = "scene", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    for (const std::string& scenario : wanted) {
        const auto* const rest = std::ranges::find(rests, scenario, [](test::RestScene s) { return name(s); });
        if (scenario == "pile") {
            runPile(options, results);
        } else if (scenario == "methods") {
            runMethods(options, results);
        } else if (rest != rests.end()) {
            runRest(*rest, options, results);
        } else {
            throw std::invalid_argument("--scenario: '" + scenario +
                                        "' is not pile, u_on_bar, cross_in_hole, interlocked_tori or methods");
        }
    }
    return results;
}

}  // namespace grapeshot::bench
