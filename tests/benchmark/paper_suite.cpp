// The experiment is that of:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, figures 12,
// 13
#include "paper_suite.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include <grapeshot/adb/reference/sphere.hpp>

#include "paper_measure.hpp"
#include "paper_models.hpp"
#include "paper_plots.hpp"
#include "paper_published.hpp"
#include "paper_surface.hpp"

namespace grapeshot::bench {

namespace {

using reference::Settings;

report::Row rowFor(const std::string& scenario, const PaperModel& model, const std::string& method) {
    report::Row row;
    row.scenario = scenario;
    row.mesh = model.name;
    row.triangles = model.mesh.triangles.size();
    row.method = method;
    row.peer = "exact DOP-tree";
    return row;
}

/// Means of the curves as printed in the text, and the medians of what the plots show.
void addPublishedRows(const std::vector<PublishedCurve>& curves, report::Report& results) {
    struct Printed {
        const char* model;
        const char* adb;
        double errorPercent;        ///< 0.4 to 2.1
        double errorPercentNarrow;  ///< 1 to 2
    };
    for (const Printed& printed :
         {Printed{"car", "28167", 1.89, 3.19}, {"lock", "62023", 1.54, 1.71}, {"pipes", "9814", 2.10, 3.15}}) {
        const PublishedCurve& adb = find(curves, "fig12_time_ms", printed.model, printed.adb);
        const std::string exact = std::string(printed.model) == "pipes" ? "DOP9814" : std::string("DOP") + printed.adb;
        const PublishedCurve ratio = quotient(find(curves, "fig12_time_ms", printed.model, exact), adb);
        const PublishedCurve& error = find(curves, "fig13_error_pct", printed.model, printed.adb);
        report::Row row;
        row.scenario = "summary";
        row.mesh = printed.model;
        row.triangles = static_cast<std::size_t>(std::stoul(printed.adb));
        row.method = "published";
        row.peer = "exact DOP-tree";
        row.ratio = report::median(ratio.values);
        row.measured = {{"errorMeanPct", printed.errorPercent},
                        {"errorMeanPct1to2", printed.errorPercentNarrow},
                        {"errorWorstPct", *std::ranges::max_element(error.values)},
                        {"speedUpMedian", row.ratio}};
        results.rows.push_back(row);
    }
}

void addSummary(const PaperModel& model, const std::string& method, const std::vector<PaperErrors>& errors,
                const PaperTimes& times, const Turns& turns, const PaperTruth& truth,
                const report::NamedNumbers& parameters, report::Report& results) {
    report::Row row = rowFor("summary", model, method);
    fillRow(row, total(errors), truth.poses);
    double worst = 0;
    for (const PaperErrors& one : errors) {
        worst = std::max(worst, one.percent());
    }
    row.measured = parameters;
    row.measured.insert(row.measured.end(), {{"errorMeanPct", meanPercent(errors, turns, 0, INFINITY)},
                                             {"errorMeanPct1to2", meanPercent(errors, turns, 1, 2)},
                                             {"errorWorstPct", worst},
                                             {"speedUpMedian", report::median(times.dopRatio)},
                                             {"speedUpOverAabbMedian", report::median(times.boxRatio)},
                                             {"exactDopTests", truth.dopTests},
                                             {"exactAabbTests", truth.boxTests}});
    row.timeUs = report::quantiles(times.adb);
    row.ratio = report::median(times.dopRatio);
    results.rows.push_back(row);
}

struct Measured {
    std::vector<PaperErrors> errors;
    PaperTimes times;
};

Measured measurePoint(const PaperModel& model, const std::string& method, const Point& point, const Turns& turns,
                      const PaperTruth& truth, int repetitions, report::Report& results) {
    const reference::CellCounts cells = reference::countCells(model.boxes, point.fill);
    const Settings settings = paperSettings(point.pMin);
    reference::AdbQuery<reference::Box> query({model.boxes, cells}, {model.boxes, cells}, settings);
    Measured measured{errorsOf(query, turns, truth), timesOf(query, model, turns, repetitions)};
    addSummary(model, method, measured.errors, measured.times, turns, truth, parameters(point, settings.kMin), results);
    return measured;
}

MeasuredCurves addDistances(const PaperModel& model, const std::vector<PaperErrors>& errors, const PaperTimes& times,
                            const Turns& turns, report::Report& results) {
    MeasuredCurves curves{model.name, turns.distances, {}, times.adb, times.dop, times.dopRatio};
    for (std::size_t d = 0; d < turns.distances.size(); ++d) {
        report::Row row = rowFor("distance", model, "ADB of AABBs");
        fillRow(row, errors[d], turns.poses[d].size());
        row.timeUs.mean = times.adb[d];
        row.ratio = times.dopRatio[d];
        row.measured = {{"distance", turns.distances[d]},
                        {"errorPct", errors[d].percent()},
                        {"exactDopUs", times.dop[d]},
                        {"exactAabbUs", times.box[d]}};
        results.rows.push_back(row);
        curves.errorPercent.push_back(errors[d].percent());
    }
    return curves;
}

/// The same point over another kind of volume.
template <class V>
void addVolume(const PaperModel& model, const std::string& method, const Point& point, const Turns& turns,
               const PaperTruth& truth, report::Report& results) {
    const reference::BoundedTree<V> tree = reference::bounded<V>(model.boxes.hierarchy);
    const reference::CellCounts cells = reference::countCells(tree, point.fill);
    const Settings settings = paperSettings(point.pMin);
    reference::AdbQuery<V> query({tree, cells}, {tree, cells}, settings);
    addSummary(model, method, errorsOf(query, turns, truth), timesOf(query, model, turns, 1), turns, truth,
               parameters(point, settings.kMin), results);
}

/// One assumption at a time taken out, or one printed version instead of another.
void addVariants(const PaperModel& model, const Point& point, const Turns& turns, const PaperTruth& truth,
                 report::Report& results) {
    const reference::CellCounts cells = reference::countCells(model.boxes, point.fill);
    const auto add = [&](const std::string& method, const reference::CellCounts& counts, Settings settings) {
        settings.mostPairs = paperSettings(0).mostPairs;
        reference::AdbQuery<reference::Box> query({model.boxes, counts}, {model.boxes, counts}, settings);
        addSummary(model, method, errorsOf(query, turns, truth), timesOf(query, model, turns, 1), turns, truth,
                   parameters({counts.settings, settings.pMin}, settings.kMin), results);
    };
    const auto fitted = [&](const std::function<void(Settings&)>& change) {
        Settings settings = paperSettings(point.pMin);
        change(settings);
        return settings;
    };
    add("chapter 2007, pMin .99", cells, reference::chapter2007());
    add("STAR, pMin .99", cells, reference::star());
    add("slide, pMin .99", cells, reference::slide());
    add("STAR, fitted pMin", cells, fitted([](Settings& s) { s.kMin = 1; }));
    add("slide, fitted pMin", cells, fitted([](Settings& s) {
            s.kMin = 1;
            s.insert = reference::Insert::overlapping;
        }));
    add("p = 0 kept", cells, fitted([](Settings& s) { s.insert = reference::Insert::overlapping; }));
    add("evidence counted once", cells, fitted([](Settings& s) { s.nestedEvidence = false; }));
    add("unequal pairs descend", cells,
        fitted([](Settings& s) { s.unequalPairs = reference::UnequalPairs::descendInner; }));
    add("leaves tested", cells, fitted([](Settings& s) {
            s.unequalPairs = reference::UnequalPairs::descendInner;
            s.leafPairs = reference::LeafPairs::testExact;
            s.insert = reference::Insert::overlapping;
        }));
    add("LB by curvature", cells, fitted([](Settings& s) { s.lowerBound = reference::LowerBound::curvature; }));
    add("tau 1", reference::countCells(model.boxes, {point.fill.grid, 1}), fitted([](Settings&) {}));
    addVolume<PaperDop>(model, "ADB of 18-DOPs", point, turns, truth, results);
    addVolume<reference::Sphere>(model, "ADB of spheres", point, turns, truth, results);
}

}  // namespace

report::Report runPaperSuite(const Options& options) {
    const bool quick = options.quick;
    const std::vector<PublishedCurve> published = readPublished(GRAPESHOT_PUBLISHED);
    DistanceRange range = options.distances;
    if (quick) {
        range.step = std::max(range.step, 0.2);
    }
    const Turns all = turns(range, options.poses.value_or(quick ? 8 : 200));
    // The surface has hundreds of points: every second distance is enough for it.
    const Turns coarse = turns({range.low, range.high, 2 * range.step}, quick ? 6 : 40);
    const int repetitions = options.repetitions.value_or(quick ? 1 : 3);

    report::Report results{.suite = "paper", .seed = options.seed, .quick = quick, .rows = {}, .claims = {}};
    std::vector<PaperModel> fitted;
    for (NamedMesh& shape : fittedShapes(quick)) {
        fitted.push_back(paperModel(std::move(shape)));
    }
    const PaperSurface surface = measureSurface(fitted, coarse, quick);
    const Point& point = surface.accurate;
    for (const Point& fit : {surface.accurate, surface.fast}) {
        std::cerr << "fitted: tau " << fit.fill.tau << ", grid " << fit.fill.grid << ", pMin " << fit.pMin << "\n";
    }
    std::cerr << (surface.fasterThanExact ? "" : "no point is faster than the exact DOP-tree\n");

    std::vector<NamedMesh> shapes;
    for (const std::string& file : options.meshes) {
        shapes.push_back(fileMesh(file));
    }
    if (shapes.empty()) {
        shapes = shownShapes(quick);
    }
    addPublishedRows(published, results);
    std::vector<MeasuredCurves> curves;
    std::vector<report::Row> distanceRows;
    std::size_t disagreeing = 0;
    std::size_t colliding = 0;
    std::size_t poses = 0;
    for (NamedMesh& shape : shapes) {
        const PaperModel model = paperModel(std::move(shape));
        std::cerr << model.name << " ...\n";
        const PaperTruth truth = truthOf(model, all);
        const Measured accurate =
            measurePoint(model, "ADB of AABBs", surface.accurate, all, truth, repetitions, results);
        measurePoint(model, "ADB of AABBs, fast", surface.fast, all, truth, repetitions, results);
        addVariants(model, point, coarse, truthOf(model, coarse), results);
        report::Report distances;
        curves.push_back(addDistances(model, accurate.errors, accurate.times, all, distances));
        distanceRows.insert(distanceRows.end(), distances.rows.begin(), distances.rows.end());
        disagreeing += truth.betweenExact + truth.withLibrary;
        colliding += total(accurate.errors).colliding;
        poses += total(accurate.errors).n;
    }
    results.rows.insert(results.rows.end(), distanceRows.begin(), distanceRows.end());
    results.rows.insert(results.rows.end(), surface.rows.begin(), surface.rows.end());
    if (!options.plotFolder.empty()) {
        drawPaperPlots(curves, published, options.plotFolder);
    }
    const double share = static_cast<double>(colliding) / static_cast<double>(poses);
    results.claims.push_back({"poses on which two exact answers differ", static_cast<double>(disagreeing), false, 0});
    results.claims.push_back({"share of colliding poses", share, true, 0.1});
    results.claims.push_back({"share of colliding poses", share, false, 0.9});
    return results;
}

}  // namespace grapeshot::bench
