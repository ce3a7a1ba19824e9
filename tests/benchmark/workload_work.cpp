#include <map>

#include "comparison.hpp"
#include "gates.hpp"
#include "pose_sets.hpp"
#include "stopped.hpp"
#include "workload_scenes.hpp"

namespace grapeshot::bench {

namespace {

struct WorkMethod {
    std::string name;
    DecideSettings settings;
};

std::vector<WorkMethod> allMethods() {
    std::vector<WorkMethod> methods{{"exact", exactShuffled()}, {"hybrid", hybridShuffled()}};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.push_back({estimate.name, estimate.settings()});
    }
    return methods;
}

/// Of one method, in one place or in all.
struct Tally {
    std::vector<double> work;
    Errors errors;
    double colliding = 0;
};

report::Row rowOf(const std::string& scenario, const std::string& mesh, std::size_t triangles,
                  const std::string& method, const Tally& tally) {
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh;
    row.triangles = triangles;
    row.method = method;
    row.n = tally.work.size();
    row.falseNegatives = tally.errors.falseNegatives;
    row.falsePositives = tally.errors.falsePositives;
    row.colliding = tally.colliding;
    row.measured = {{"errorPct", tally.errors.percentOf(row.n)}};
    addWork(tally.work, row);
    return row;
}

/// In the order of the methods.
std::vector<Tally> talliesOf(const Tree& tree, const std::vector<Pose>& poses, WorkloadCheck& check) {
    const Truth truth = exactTruth(tree, tree, poses);
    check.uncertain += static_cast<double>(truth.uncertain);
    check.poses += static_cast<double>(poses.size());
    check.colliding += static_cast<double>(truth.colliding);
    std::vector<Tally> tallies;
    for (const WorkMethod& method : allMethods()) {
        Tally& tally = tallies.emplace_back();
        Query query(tree, tree);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const Decision decision = query.decide(poses[i], method.settings);
            tally.errors.add(decision.collides, truth.collides[i] != 0);
            tally.work.push_back(static_cast<double>(decision.work));
        }
        tally.colliding = static_cast<double>(truth.colliding);
    }
    return tallies;
}

}  // namespace

std::vector<report::Row> workRows(const std::vector<TreeOf>& meshes, int zachmann, int grazing, std::uint64_t seed,
                                  WorkloadCheck& check) {
    const std::vector<WorkMethod> methods = allMethods();
    std::map<std::string, std::vector<Tally>> pooled;
    std::vector<report::Row> rows;
    for (const TreeOf& mesh : meshes) {
        const std::pair<std::string, test::PoseSet> sets[] = {
            {"work, zachmann", zachmannSet(*mesh.tree, zachmann, seed)},
            {"work, grazing", grazingSet(*mesh.tree, grazing, seed)}};
        for (const auto& [scenario, set] : sets) {
            const std::vector<Tally> tallies = talliesOf(*mesh.tree, set.poses, check);
            std::vector<Tally>& all = pooled[scenario];
            all.resize(methods.size());
            for (std::size_t m = 0; m < methods.size(); ++m) {
                rows.push_back(rowOf(scenario, mesh.name, mesh.tree->triangles.size(), methods[m].name, tallies[m]));
                all[m].work.insert(all[m].work.end(), tallies[m].work.begin(), tallies[m].work.end());
                all[m].errors.falseNegatives += tallies[m].errors.falseNegatives;
                all[m].errors.falsePositives += tallies[m].errors.falsePositives;
                all[m].colliding += tallies[m].colliding;
            }
        }
    }
    for (const auto& [scenario, tallies] : pooled) {
        for (std::size_t m = 0; m < methods.size(); ++m) {
            rows.push_back(rowOf(scenario, "all " + std::to_string(meshes.size()), 0, methods[m].name, tallies[m]));
        }
    }
    return rows;
}

}  // namespace grapeshot::bench
