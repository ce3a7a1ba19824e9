#include "contacts_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>

#include <grapeshot/narrowphase/mesh_model.hpp>
#include <support/poses.hpp>

#include "contact_methods.hpp"
#include "contact_plots.hpp"
#include "gates.hpp"
#include "measured_depth.hpp"
#include "meshes.hpp"

namespace grapeshot::bench {

namespace {

constexpr double meshSize = 2;  ///< box diagonal of the reported meshes, m
constexpr std::uint64_t budgets[] = {2, 4, 8, 16, 32, 64, 128, 256};
constexpr std::size_t levels[] = {30, 40, 60, 90, 125, 150, 180, 210, 250, 300, 350, 420, 500, 700, 1000, 2000, 4000};

struct Penetration {
    const char* name;
    double gap;  ///< of the box's diagonal
};
constexpr Penetration penetrations[] = {{"1.5 %", -0.015}, {"5 %", -0.05}};

struct MeasuredContacts {
    std::string name;
    std::uint64_t budget = 0;
    std::size_t triangles = 0;
    double us = 0;
    double position = 0, normal = 0, recall = 0;  ///< 90th percentiles; percent
    [[nodiscard]] bool isAsGoodAs(const MeasuredContacts& other) const {
        return position <= other.position && normal <= other.normal && recall >= other.recall;
    }
};

/// How many times as fast as the fastest mesh that is as good in all three: a decimated one, or the mesh itself. 0 if
/// it found nothing, which is no merit.
double againstDecimated(const MeasuredContacts& method, const std::vector<MeasuredContacts>& all) {
    if (std::isnan(method.position)) {
        return 0;
    }
    double fastest = std::numeric_limits<double>::infinity();
    for (const MeasuredContacts& one : all) {
        if ((one.triangles > 0 || one.budget == unlimited) && one.isAsGoodAs(method)) {
            fastest = std::min(fastest, one.us);
        }
    }
    return fastest / method.us;
}

report::Row rowOf(const RegionScore& scored, const Times& times) {
    report::Row row;
    row.timeUs.p50 = report::median(times);
    const Score reliability = score(scored.forecasts);
    row.measured = {{"recallPct", scored.recallPercent()},
                    {"lengthRecallPct", scored.lengthRecallPercent()},
                    {"precisionPct", scored.precisionPercent()},
                    {"positionP50Pct", report::quantile(scored.positionPercent, 0.5)},
                    {"positionP90Pct", report::quantile(scored.positionPercent, 0.9)},
                    {"normalP50Deg", report::quantile(scored.normalDegrees, 0.5)},
                    {"normalP90Deg", report::quantile(scored.normalDegrees, 0.9)},
                    {"depthRatioP10", report::quantile(scored.depthRatio, 0.1)},
                    {"depthRatioP50", report::quantile(scored.depthRatio, 0.5)},
                    {"depthRatioP90", report::quantile(scored.depthRatio, 0.9)},
                    {"forceP50Deg", report::quantile(scored.forceDegrees, 0.5)},
                    {"forceP90Deg", report::quantile(scored.forceDegrees, 0.9)},
                    {"forceRatioP50", report::quantile(scored.forceRatio, 0.5)},
                    {"torqueP50Deg", report::quantile(scored.torqueDegrees, 0.5)},
                    {"torqueP90Deg", report::quantile(scored.torqueDegrees, 0.9)},
                    {"torqueRatioP50", report::quantile(scored.torqueRatio, 0.5)},
                    {"regionEce", scored.forecasts.empty() ? report::notApplicable : reliability.ece},
                    {"timeSpread", report::spread(times)}};
    return row;
}

struct ContactSizes {
    int poses, repetitions;
};

/// Ratios to the decimated mesh by the estimate's budget, one per mesh and penetration.
using RatiosByBudget = std::map<std::uint64_t, std::vector<double>>;

void runPoses(const NamedMesh& named, const MeshModel& model, const Penetration& penetration, const ContactSizes& sizes,
              const std::vector<ContactMethod>& methods, const Options& options, RatiosByBudget& ratiosByBudget,
              std::vector<Forecast>& forecasts, report::Report& results) {
    const Tree& tree = model.tree;
    ContactMethod exact = estimateMethod(tree, unlimited);
    std::vector<Pose> poses;
    std::vector<Regions> truth;
    std::vector<std::vector<float>> depths;
    double regions = 0;
    for (const Pose& pose : test::grazingPoses(tree, tree, sizes.poses, penetration.gap, options.seed)) {
        Regions found;
        exact.find(pose, found);
        if (!found.empty()) {
            poses.push_back(pose);
            depths.push_back(measuredDepths(model, model, pose, found, contactRegions));
            regions += static_cast<double>(found.size());
            truth.push_back(std::move(found));
        }
    }
    const Eigen::Vector3f about = 0.5F * (tree.lower + tree.upper);

    std::vector<ContactMethod> all = methods;
    all.push_back(std::move(exact));
    std::vector<Contender> contenders;
    for (const ContactMethod& method : all) {
        contenders.push_back(contender(method, poses));
    }
    const std::vector<Times> times = interleaved(contenders, poses.size(), sizes.repetitions);
    std::vector<MeasuredContacts> measuredOnes;
    for (std::size_t m = 0; m < all.size(); ++m) {
        RegionScore scored(contactRegions, meshSize);
        double work = 0;
        Regions found;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            all[m].find(poses[i], found);
            work += static_cast<double>(all[m].work());
            scored.add(truth[i], depths[i], found, about);
        }
        report::Row row = rowOf(scored, times[m]);
        row.scenario = std::string("penetration ") + penetration.name;
        row.mesh = named.name;
        row.triangles = tree.triangles.size();
        row.method = all[m].name;
        row.n = poses.size();
        row.work = {{"workMean", work / static_cast<double>(poses.size())},
                    {"trueRegions", regions / static_cast<double>(poses.size())}};
        measuredOnes.push_back({all[m].name, all[m].budget, all[m].triangles, row.timeUs.p50,
                                report::quantile(scored.positionPercent, 0.9),
                                report::quantile(scored.normalDegrees, 0.9), scored.recallPercent()});
        results.rows.push_back(std::move(row));
        if (all[m].name.starts_with("estimate")) {
            forecasts.insert(forecasts.end(), scored.forecasts.begin(), scored.forecasts.end());
        }
    }
    const std::size_t firstRow = results.rows.size() - all.size();
    for (std::size_t m = 0; m < all.size(); ++m) {
        report::Row& row = results.rows[firstRow + m];
        row.measured.emplace_back("exactTimeRatio", measuredOnes.back().us / measuredOnes[m].us);
        if (all[m].name.starts_with("estimate")) {
            row.peer = "decimated, as good";
            row.ratio = againstDecimated(measuredOnes[m], measuredOnes);
            ratiosByBudget[all[m].budget].push_back(row.ratio);
        }
    }
    if (!options.plotFolder.empty()) {
        std::vector<ContactCurve> curves{
            {"estimate", {}, {}, {}, {}}, {"decimated", {}, {}, {}, {}}, {"exact stopped", {}, {}, {}, {}}};
        for (const MeasuredContacts& one : measuredOnes) {
            for (ContactCurve& curve : curves) {
                if (one.name.starts_with(curve.name)) {
                    curve.add(one.us, one.position, one.normal, one.recall);
                }
            }
        }
        drawContactPlots(curves, named.name + std::string(", ") + penetration.name, options.plotFolder);
    }
}

}  // namespace

report::Report runContactsSuite(const Options& options) {
    const ContactSizes sizes{.poses = options.poses.value_or(options.quick ? 12 : 250),
                             .repetitions = options.repetitions.value_or(options.quick ? 1 : 5)};
    report::Report results{.suite = "contacts", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    RatiosByBudget ratiosByBudget;
    std::vector<Forecast> forecasts;
    std::size_t meshes = 0;
    constexpr std::size_t largeMesh = 70'000;
    for (const NamedMesh& named : reportedMeshes(options.meshes, options.quick)) {
        if (!options.quick && options.meshes.empty() && named.mesh.triangles.size() < largeMesh) {
            continue;
        }
        std::cerr << named.name << " ...\n";
        ++meshes;
        const MeshModel model = makeModel(named.mesh.view());
        std::vector<ContactMethod> methods;
        for (const std::uint64_t budget : budgets) {
            methods.push_back(estimateMethod(model.tree, budget));
        }
        for (const std::size_t triangles : levels) {
            if (triangles < model.tree.triangles.size()) {
                methods.push_back(decimatedMethod(model.tree.mesh(), triangles));
            }
        }
        for (const std::uint64_t budget : {std::uint64_t{16}, std::uint64_t{64}, std::uint64_t{256}}) {
            methods.push_back(stoppedMethod(model.tree, budget));
        }
        for (const Penetration& penetration : penetrations) {
            runPoses(named, model, penetration, sizes, methods, options, ratiosByBudget, forecasts, results);
        }
    }
    for (const auto& [budget, ratios] : ratiosByBudget) {
        report::Row row;
        row.scenario = "penetrations";
        row.mesh = "mean of " + std::to_string(meshes);
        row.method = "estimate " + std::to_string(budget);
        row.peer = "decimated, as good";
        row.n = ratios.size();
        row.ratio = report::geometricMean(ratios);
        results.rows.push_back(row);
    }
    const Score reliability = score(forecasts);
    results.claims.push_back({"regions that are not proven, so that there is something to judge",
                              static_cast<double>(forecasts.size()), true, 10});
    if (!options.quick) {
        results.claims.push_back({"estimate " + std::to_string(contactGate.steps) +
                                      ": time of the decimated mesh as good / its, geometric mean",
                                  report::geometricMean(ratiosByBudget.at(contactGate.steps)), true,
                                  contactGate.speedUp});
        results.claims.push_back({"calibration error of the regions' probabilities", reliability.ece, false,
                                  contactGate.regionCalibrationError});
    }
    return results;
}

}  // namespace grapeshot::bench
