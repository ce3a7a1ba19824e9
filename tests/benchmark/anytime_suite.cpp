// The question is that of:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
#include "anytime_suite.hpp"

#include <algorithm>
#include <iostream>

#include "anytime_plots.hpp"
#include "anytime_scenes.hpp"
#include "fit_meshes.hpp"
#include "gates.hpp"
#include "pose_sets.hpp"
#include "truncated.hpp"
#include "truth.hpp"

namespace grapeshot::bench {

namespace {

struct Sizes {
    int zachmann, grazing;  ///< poses per mesh
    int unlikePairs, nested;
    int repetitions;
};

/// Of one kind of poses, over all meshes; ours first.
struct Pooled {
    std::string scenario;
    std::vector<Series> series;
    std::size_t meshes = 0;
};

void add(std::vector<report::Row>& rows, const std::vector<report::Row>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
}

void addPoses(const TreeOf& mesh, const test::PoseSet& set, const StoppedPrior& prior, int repetitions, Pooled& pooled,
              ResumeCheck& check, report::Report& results) {
    const Truth truth = exactTruth(*mesh.tree, *mesh.tree, set.poses);
    const Series ours = estimates(*mesh.tree, *mesh.tree, set.poses, truth.collides, stepBudgets, repetitions, check);
    add(results.rows, rowsOf(ours, pooled.scenario, mesh.name, mesh.tree->triangles.size()));
    pool(pooled.series, {ours});
    pool(pooled.series, rivals(*mesh.tree, set.poses, truth.collides, prior));
    ++pooled.meshes;
}

/// Ours, and what is shown of the rivals.
std::vector<Series> shownOf(const Pooled& pooled) {
    std::vector<Series> shown{pooled.series.front(), bestOf(pooled.series, "exact, else no"),
                              bestOf(pooled.series, "exact, else prior")};
    for (const int triangles : truncations) {
        shown.push_back(bestOf(pooled.series, "truncated " + std::to_string(triangles) + " triangles"));
    }
    return shown;
}

void addPooled(const Pooled& pooled, const std::string& plotFolder, report::Report& results) {
    const std::vector<Series> shown = shownOf(pooled);
    for (const Series& series : shown) {
        add(results.rows, rowsOf(series, pooled.scenario, "all " + std::to_string(pooled.meshes), 0));
    }
    if (!plotFolder.empty()) {
        drawAnytimePlots(shown, pooled.scenario, plotFolder);
    }
}

/// Our error over that of the rival, at equal steps; the worst of all numbers of steps.
double worstAgainst(const Series& ours, const Series& rival) {
    constexpr double hopeless = 100;  // where the rival makes no error and we do
    double worst = 0;
    for (std::size_t k = 0; k < ours.at.size(); ++k) {
        const double error = score(ours.at[k].forecasts).errorPercent;
        const double theirs = score(rival.at[k].forecasts).errorPercent;
        worst = std::max(worst, theirs > 0 ? error / theirs : error > 0 ? hopeless : 0);
    }
    return worst;
}

void claim(const std::vector<Series>& zachmann, report::Report& results) {
    /// Fewer answers than this in doubt say nothing about calibration: of so many and 16 bins, chance alone makes 0.04.
    constexpr std::size_t enough = 1'000;
    double ece = 0;
    double inDoubt = 0;
    for (const Stopped& at : zachmann.front().at) {
        const Score result = score(at.forecasts);
        ece = std::max(ece, result.ece);
        const auto* const gate = std::ranges::find(stepGates, at.steps, &StepGate::steps);
        if (gate != std::end(stepGates)) {
            inDoubt = std::max(inDoubt, result.inDoubt >= enough ? result.eceInDoubt : 0);
            results.claims.push_back({"wrong after " + std::to_string(at.steps) + " steps, %", result.errorPercent,
                                      false, gate->errorPercent});
        }
    }
    results.claims.push_back({"calibration error (20 bins of equal width), largest of all numbers of steps", ece, false,
                              largestCalibrationError});
    results.claims.push_back({"the same of answers in doubt (P from 0.1 to 0.9), after 1 to 8 steps", inDoubt, false,
                              largestCalibrationErrorInDoubt});
    results.claims.push_back({"error / that of the exact traversal stopped at equal steps, worst",
                              worstAgainst(zachmann.front(), bestOf(zachmann, "exact")), false, 1});
    results.claims.push_back({"error / that of the truncated tree stopped at equal steps, worst",
                              worstAgainst(zachmann.front(), bestOf(zachmann, "truncated")), false, 1});
}

}  // namespace

report::Report runAnytimeSuite(const Options& options) {
    const bool quick = options.quick;
    const Sizes sizes = quick ? Sizes{.zachmann = options.poses.value_or(600),
                                      .grazing = 60,
                                      .unlikePairs = 300,
                                      .nested = 10,
                                      .repetitions = options.repetitions.value_or(1)}
                              : Sizes{.zachmann = options.poses.value_or(24'000),
                                      .grazing = 1'200,
                                      .unlikePairs = 10'000,
                                      .nested = 100,
                                      .repetitions = options.repetitions.value_or(3)};
    const StoppedPrior prior(fitMeshes(quick), quick ? 240 : 2'400, options.seed + 1);

    report::Report results{.suite = "anytime", .seed = options.seed, .quick = quick, .rows = {}, .claims = {}};
    ResumeCheck check;
    Pooled zachmann{"zachmann", {}};
    Pooled grazing{"grazing", {}};
    const NamedTrees trees(reportedMeshes(options.meshes, quick));
    const std::vector<TreeOf>& meshes = trees.all();
    for (const TreeOf& mesh : meshes) {
        std::cerr << mesh.name << " ...\n";
        addPoses(mesh, zachmannSet(*mesh.tree, sizes.zachmann, options.seed), prior, sizes.repetitions, zachmann, check,
                 results);
        addPoses(mesh, grazingSet(*mesh.tree, sizes.grazing, options.seed), prior, sizes.repetitions, grazing, check,
                 results);
        constexpr std::size_t mostNested = 100'000;  // of larger ones a single exact answer takes long
        if (mesh.tree->triangles.size() <= mostNested) {
            add(results.rows, nestedShells(mesh, sizes.nested, options.seed, check));
        }
    }
    if (meshes.size() > 1) {
        std::cerr << "unlike pairs ...\n";
        add(results.rows, unlikePairsAtSteps(meshes, sizes.unlikePairs, options.seed, check));
    }
    addPooled(grazing, options.plotFolder, results);
    addPooled(zachmann, options.plotFolder, results);
    const Score first = score(zachmann.series.front().at.front().forecasts);
    const double colliding = static_cast<double>(first.colliding) / static_cast<double>(first.n);
    results.claims.push_back({"answers stopped and resumed", check.queries, true, 1'000});
    results.claims.push_back({"of them with another end than in one go", check.otherEnds, false, 0});
    results.claims.push_back({"of them not certain or wrong in the end", check.wrongInTheEnd, false, 0});
    results.claims.push_back({"share of colliding poses", colliding, true, 0.1});
    results.claims.push_back({"share of colliding poses", colliding, false, 0.9});
    if (!quick) {
        claim(zachmann.series, results);
    }
    return results;
}

}  // namespace grapeshot::bench
