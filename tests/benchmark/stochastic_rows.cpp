#include "stochastic_rows.hpp"

#include <iostream>

#include <grapeshot/core/rate_bound.hpp>

#include "stochastic_published.hpp"

namespace grapeshot::bench {

namespace {

report::Row rowFor(const std::string& scenario, const std::string& method, std::size_t triangles,
                   const Recall& recall) {
    report::Row row;
    row.scenario = scenario;
    row.triangles = triangles;
    row.method = method;
    row.n = recall.steps;
    row.colliding = static_cast<double>(recall.regions[1]);
    row.falseNegatives = static_cast<double>(recall.regions[1] - recall.found[1]);
    row.falsePositives = static_cast<double>(recall.outside);
    const auto steps = static_cast<double>(recall.steps);
    row.timeUs.mean = recall.timeUs / steps;
    row.work = {{"featureDistances", recall.featureDistances / steps},
                {"trianglePairs", recall.trianglePairs / steps},
                {"boxTests", recall.boxTests / steps},
                {"activePairs", recall.activePairs / steps}};
    for (const int age : publishedSteps) {
        row.measured.emplace_back("found" + std::to_string(age) + "Pct", 100 * recall.share(age));
    }
    report::NamedCurves curves{{"age", {}}, {"regions", {}}, {"foundPct", {}}, {"lowPct", {}}, {"highPct", {}}};
    for (std::size_t age = 1; age <= mostAge; ++age) {
        const std::size_t found = recall.found[age];
        const std::size_t regions = recall.regions[age];
        curves[0].second.push_back(static_cast<double>(age));
        curves[1].second.push_back(static_cast<double>(regions));
        curves[2].second.push_back(100 * recall.share(static_cast<int>(age)));
        curves[3].second.push_back(100 * lowerRate(found, regions, 0.975));
        curves[4].second.push_back(100 * upperRate(found, regions, 0.975));
    }
    row.measured.emplace_back("low1Pct", curves[3].second[0]);
    row.measured.emplace_back("high1Pct", curves[4].second[0]);
    row.measured.emplace_back("low4Pct", curves[3].second[3]);
    row.measured.emplace_back("high4Pct", curves[4].second[3]);
    row.measured.emplace_back("stepsTo98", recall.stepsTo(0.98));
    row.curves = std::move(curves);
    return row;
}

}  // namespace

std::vector<Recall> measureScenes(const std::vector<ApproachScene>& scenes,
                                  const std::vector<StochasticMethod>& methods, int episodes, std::uint64_t seed,
                                  report::Report& results) {
    std::vector<Recall> together(methods.size());
    std::size_t triangles = 0;
    for (const ApproachScene& scene : scenes) {
        std::cerr << scene.name << " ...\n";
        const std::vector<Recall> recalls = measureRecall(scene, methods, episodes, seed);
        const std::size_t count = scene.a.triangles.size() + scene.b.triangles.size();
        triangles += count;
        for (std::size_t m = 0; m < methods.size(); ++m) {
            results.rows.push_back(rowFor(scene.name, methods[m].name, count, recalls[m]));
            together[m].add(recalls[m]);
        }
    }
    for (std::size_t m = 0; m < methods.size(); ++m) {
        results.rows.push_back(rowFor("all", methods[m].name, triangles, together[m]));
    }
    return together;
}

}  // namespace grapeshot::bench
