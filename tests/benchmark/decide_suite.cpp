// The procedure is that of:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002, section 6 (two copies of an object, a range of
// centre distances, many rotations each)
#include "decide_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "comparison.hpp"
#include "fit_meshes.hpp"
#include "gates.hpp"
#include "limits_scan.hpp"
#include "meshes.hpp"
#include "nested_shells.hpp"
#include "pose_sets.hpp"
#include "stopped.hpp"
#include "truncated.hpp"

namespace grapeshot::bench {

namespace {

struct DecideSizes {
    int zachmann, slowPeers, grazing, nested;  ///< poses of each kind per mesh
    int repetitions;
};

struct Totals {
    double disagreements = 0, uncertain = 0, poses = 0;
    double leastColliding = 1, mostColliding = 0;
    void add(const Truth& truth) {
        const auto n = static_cast<double>(truth.collides.size());
        disagreements += static_cast<double>(truth.disagreements);
        uncertain += static_cast<double>(truth.uncertain);
        poses += n;
        leastColliding = std::min(leastColliding, static_cast<double>(truth.colliding) / n);
        mostColliding = std::max(mostColliding, static_cast<double>(truth.colliding) / n);
    }
};

std::vector<Peer> fastMethods(const Tree& tree, const Peer& fcl, const StoppedPrior& prior) {
    std::vector<Peer> methods{queryPeer("exact", tree, tree, exactShuffled()), fcl,
                              queryPeer("hybrid", tree, tree, hybridShuffled())};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.push_back(queryPeer(estimate.name, tree, tree, estimate.settings()));
    }
    for (const int triangles : truncations) {
        methods.push_back(truncatedPeer(tree, triangles));
    }
    for (const std::size_t triangles : {350, 500, 1000, 4000}) {
        if (std::optional<Peer> peer = decimatedPeer(tree.mesh(), triangles)) {
            methods.push_back(std::move(*peer));
        }
    }
    for (const std::size_t budget : {std::size_t{2}, std::size_t{4}}) {
        methods.push_back(stoppedPeer(tree, tree, budget));
        methods.push_back(stoppedPeer(tree, tree, budget, prior));
    }
    return methods;
}

/// The first poses of a set: it is shuffled, so all distances are in.
test::PoseSet beginning(const test::PoseSet& set, std::size_t count) {
    test::PoseSet part = set;
    part.poses.resize(std::min(count, set.poses.size()));
    part.distanceIndex.resize(part.poses.size());
    return part;
}

Truth beginning(const Truth& truth, std::size_t count) {
    Truth part;
    part.collides.assign(truth.collides.begin(), truth.collides.begin() + static_cast<std::ptrdiff_t>(count));
    part.colliding = static_cast<std::size_t>(std::ranges::count(part.collides, 1));
    return part;
}

void runMesh(const NamedMesh& named, const Options& options, const DecideSizes& sizes, const StoppedPrior& prior,
             Totals& zachmannTotals, Totals& grazingTotals, report::Report& results) {
    const MeshView mesh = named.mesh.view();
    const Tree tree = build(mesh);
    const Peer fcl = fclPeer(mesh, mesh);
    const auto add = [&](const char* scenario, const test::PoseSet& set, const Truth& truth,
                         const std::vector<Peer>& methods) {
        std::vector<report::Row> rows =
            compare({scenario, named.name, mesh.triangles.size(), set, truth}, methods, sizes.repetitions);
        rows.front().measured.insert(rows.front().measured.end(),
                                     {{"disagreements", static_cast<double>(truth.disagreements)},
                                      {"borderline", static_cast<double>(truth.borderline)}});
        results.rows.insert(results.rows.end(), rows.begin(), rows.end());
    };

    const test::PoseSet zachmann = zachmannSet(tree, sizes.zachmann, options.seed);
    const Truth truth = checkedTruth(named.name, tree, tree, zachmann.poses, fcl);
    zachmannTotals.add(truth);
    const std::vector<Peer> methods = fastMethods(tree, fcl, prior);
    add("zachmann", zachmann, truth, methods);

    const test::PoseSet part = beginning(zachmann, static_cast<std::size_t>(sizes.slowPeers));
    add("zachmann, part", part, beginning(truth, part.poses.size()),
        {methods[0], fcl, gimpactPeer(mesh, mesh), odePeer(mesh, mesh)});

    const test::PoseSet grazing = grazingSet(tree, sizes.grazing, options.seed);
    const Truth grazingTruth = checkedTruth(named.name + ", grazing", tree, tree, grazing.poses, fcl);
    grazingTotals.add(grazingTruth);
    add("grazing", grazing, grazingTruth, {methods[0], fcl, methods[2]});
}

/// A mesh of more triangles takes an exact answer too long.
constexpr std::size_t mostNested = 100'000;

void runNested(const std::vector<NamedMesh>& meshes, const Options& options, const DecideSizes& sizes,
               report::Report& results) {
    double wrong = 0;
    double poses = 0;
    for (const NamedMesh& mesh : meshes) {
        if (mesh.mesh.triangles.size() > mostNested) {
            continue;
        }
        const std::vector<report::Row> rows =
            nestedRows(mesh.name, build(mesh.mesh.view()), sizes.nested, std::min(sizes.repetitions, 2), options.seed);
        results.rows.insert(results.rows.end(), rows.begin(), rows.end());
        for (const report::Row& row : rows) {
            if (row.method == "hybrid") {
                wrong += row.falseNegatives + row.falsePositives;
                poses += static_cast<double>(row.n);
            }
        }
    }
    // A small sample may have one.
    results.claims.push_back({"hybrid, nested shells: wrong answers, %", 100 * wrong / std::max(poses, 1.0), false,
                              std::max(mostNestedErrorPercent, 100 / std::max(poses, 1.0))});
}

double falseNegativesOf(const std::vector<report::Row>& rows, const std::string& beginning) {
    double sum = 0;
    for (const report::Row& row : rows) {
        sum += row.method.starts_with(beginning) && std::isfinite(row.falseNegatives) ? row.falseNegatives : 0;
    }
    return sum;
}

/// Speed and error are two claims of one gate.
void claimGate(const std::string& what, const Overall& measured, const Gate& gate, report::Report& results) {
    results.claims.push_back({what + ": exact's time / its", measured.ratioToExact, true, gate.speedUp});
    results.claims.push_back({what + ": wrong answers, %", measured.errorPercent, false, gate.errorPercent});
}

void claimSpeed(const std::vector<Overall>& zachmann, const std::vector<Overall>& grazing, report::Report& results) {
    if (const std::optional<double> least = leastRatioToFcl()) {
        results.claims.push_back({"FCL's time / that of exact, geometric mean over the meshes",
                                  of(zachmann, "exact").ratioToFcl, true, *least});
    }
    for (const EstimateSetting& estimate : estimateSettings) {
        claimGate(estimate.name, of(zachmann, estimate.name), estimate.gate, results);
    }
    claimGate("hybrid", of(zachmann, "hybrid"), hybridShuffledGate, results);
    claimGate("hybrid, grazing", of(grazing, "hybrid"), hybridGrazingGate, results);
}

}  // namespace

report::Report runDecideSuite(const Options& options) {
    const bool quick = options.quick;
    const DecideSizes sizes{.zachmann = options.poses.value_or(quick ? 1'200 : 12'000),
                            .slowPeers = quick ? 24 : 300,
                            .grazing = quick ? 120 : 1'200,
                            .nested = quick ? 12 : 40,
                            .repetitions = options.repetitions.value_or(quick ? 1 : 5)};
    report::Report results{.suite = "decide", .seed = options.seed, .quick = quick, .rows = {}, .claims = {}};
    const auto wanted = [&](const char* scenario) {
        return std::ranges::find(options.scenarios, scenario) != options.scenarios.end();
    };
    if (wanted("limits")) {
        results.rows = scanLimits(options);
        return results;
    }
    const std::vector<NamedMesh> meshes = reportedMeshes(options.meshes, quick);
    if (wanted("nested")) {
        runNested(meshes, options, sizes, results);
        return results;
    }
    const StoppedPrior prior(fitMeshes(quick), quick ? 240 : 2'400, options.seed + 1);
    Totals zachmann;
    Totals grazing;
    for (const NamedMesh& mesh : meshes) {
        std::cerr << mesh.name << " ...\n";
        runMesh(mesh, options, sizes, prior, zachmann, grazing, results);
    }
    runNested(meshes, options, sizes, results);
    const std::vector<Overall> overZachmann = overall(results.rows, "zachmann");
    const std::vector<Overall> overGrazing = overall(results.rows, "grazing");
    for (const Overall& one : overZachmann) {
        results.rows.push_back(one.row("zachmann"));
    }
    for (const Overall& one : overGrazing) {
        results.rows.push_back(one.row("grazing"));
    }
    results.claims.push_back(
        {"disagreements with FCL beyond the borderline", zachmann.disagreements + grazing.disagreements, false, 0});
    results.claims.push_back({"answers that are not certain", zachmann.uncertain + grazing.uncertain, false, 0});
    results.claims.push_back({"least share of colliding poses of a mesh", zachmann.leastColliding, true, 0.1});
    results.claims.push_back({"largest share of colliding poses of a mesh", zachmann.mostColliding, false, 0.9});
    results.claims.push_back({"least share of colliding grazing poses of a mesh", grazing.leastColliding, true, 0.3});
    results.claims.push_back({"largest share of colliding grazing poses of a mesh", grazing.mostColliding, false, 0.7});
    results.claims.push_back({"false negatives of truncated trees, which can only err the other way",
                              falseNegativesOf(results.rows, "truncated"), false, 0});
    if (!quick) {
        results.claims.push_back({"poses compared", zachmann.poses, true, 20'000});
        claimSpeed(overZachmann, overGrazing, results);
    }
    return results;
}

}  // namespace grapeshot::bench
