#include "scene_rows.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace grapeshot::bench {

using scenes::StepRecord;
using scenes::World;

namespace {

double meanOf(const Run& run, int StepRecord::*member) {
    return std::accumulate(run.steps.begin(), run.steps.end(), 0.0,
                           [&](double sum, const StepRecord& step) { return sum + step.*member; }) /
           static_cast<double>(run.steps.size());
}

std::size_t meanTriangles(const World& world) {
    std::size_t triangles = 0;
    std::size_t moving = 0;
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        if (world.moving(body)) {
            triangles += world.mesh(body).triangles.size();
            ++moving;
        }
    }
    return triangles / std::max<std::size_t>(1, moving);
}

}  // namespace

std::string atMargin(double margin) {
    char text[32];
    std::snprintf(text, sizeof text, "margin %.2f", margin);
    return text;
}

int runsOf(const Options& options) {
    return options.repetitions.value_or(options.quick ? 2 : 5);
}

HullSettings hullSettings(const Options& options) {
    HullSettings settings;
    if (options.quick) {
        settings.triangles = 200;
    }
    return settings;
}

double meanContacts(const Run& run) {
    return meanOf(run, &StepRecord::contacts);
}

report::Row rowOf(const std::string& scenario, const std::string& mesh, const Outcome& outcome,
                  const Quality& quality) {
    const Run& run = outcome.recorder.run();
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh;
    row.triangles = meanTriangles(outcome.recorder.world());
    row.method = outcome.method.name;
    row.n = run.steps.size();
    row.timeUs = report::quantiles(run.narrowphaseUs);
    row.work = {{"contacts", meanContacts(run)},
                {"manifolds", meanOf(run, &StepRecord::manifolds)},
                {"work", quality.workMean},
                {"degraded", quality.degradedMean}};
    row.measured = {{"awakeMeanUs", awakeMeanUs(run, run.narrowphaseUs)},
                    {"stepAwakeMeanUs", awakeMeanUs(run, run.stepUs)},
                    {"lost", static_cast<double>(quality.lost)},
                    {"depthP50", quality.bodyDepth.p50},
                    {"depthP99", quality.bodyDepth.p99},
                    {"depthMax", quality.bodyDepth.max},
                    {"pairDepthP99", quality.pairDepth.p99},
                    {"energyRisePct", quality.energyRisePercent},
                    {"energyOverInitialPct", quality.energyOverInitialPercent},
                    {"secondsToSleep", quality.secondsToSleep},
                    {"awakeAtEnd", static_cast<double>(quality.awakeAtEnd)},
                    {"residualRmsSpeed", quality.residualSpeed},
                    {"workBeyondBudget", quality.workBeyondBudget},
                    {"longestWait", static_cast<double>(quality.longestWait)},
                    {"pairsJudged", static_cast<double>(quality.pairsJudged)},
                    {"replaySpread", report::spread(outcome.narrowphaseTotalsUs)}};
    return row;
}

std::vector<Quality> addRows(const std::string& scenario, const std::string& mesh, const std::vector<Outcome>& outcomes,
                             const std::string& peer, report::Report& results) {
    const auto other = std::ranges::find(outcomes, peer, [](const Outcome& outcome) { return outcome.method.name; });
    std::vector<Quality> qualities;
    for (const Outcome& outcome : outcomes) {
        qualities.push_back(judge(outcome));
        report::Row row = rowOf(scenario, mesh, outcome, qualities.back());
        if (other != outcomes.end() && &*other != &outcome) {
            row.peer = peer;
            row.ratio = narrowphaseRatio(*other, outcome);
        }
        results.rows.push_back(std::move(row));
    }
    return qualities;
}

}  // namespace grapeshot::bench
