// The procedure is that of:
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002, section 6 (two copies of an object, a range of
// centre distances, many rotations each)
#include "decide_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <grapeshot/adb/query.hpp>
#include <support/poses.hpp>

#include <report/machine.hpp>
#include "clearance.hpp"
#include "fcl_peer.hpp"
#include "meshes.hpp"

namespace grapeshot::bench {

namespace {

constexpr int distances = 12;
/// Poses whose gap or depth is below this part of the mesh's size may be answered either way in single precision.
constexpr double borderline = 1e-6;

struct Answers {
    std::vector<Decision> ours;
    std::vector<char> theirs;
};

Answers answer(const Tree& tree, const FclModel& model, const std::vector<Pose>& poses) {
    Answers answers;
    Query query(tree, tree);
    for (const Pose& pose : poses) {
        answers.ours.push_back(query.decide(pose, DecideSettings::exact()));
        answers.theirs.push_back(static_cast<char>(model.decide(model, pose)));
    }
    return answers;
}

struct Timing {
    std::vector<double> ourUs, theirUs;  ///< mean per query, one value per repetition
    std::vector<double> ratios;
    std::vector<double> ourQueriesUs;  ///< per query, the least of the repetitions
};

/// Both on the same chunk of poses, one right after the other and taking turns in going first, so that whatever else
/// the machine does hits both.
Timing measure(const Tree& tree, const FclModel& model, const std::vector<Pose>& poses, int repetitions) {
    constexpr std::size_t chunk = 200;
    Timing timing;
    std::size_t collisions = 0;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        Query query(tree, tree);
        double ours = 0;
        double theirs = 0;
        for (std::size_t begin = 0; begin < poses.size(); begin += chunk) {
            const std::size_t end = std::min(begin + chunk, poses.size());
            const auto runOurs = [&] {
                const double start = report::threadCpuUs();
                for (std::size_t i = begin; i < end; ++i) {
                    collisions += query.decide(poses[i], DecideSettings::exact()).collides ? 1U : 0U;
                }
                ours += report::threadCpuUs() - start;
            };
            const auto runTheirs = [&] {
                const double start = report::threadCpuUs();
                for (std::size_t i = begin; i < end; ++i) {
                    collisions += model.decide(model, poses[i]) ? 1U : 0U;
                }
                theirs += report::threadCpuUs() - start;
            };
            if ((begin / chunk + static_cast<std::size_t>(repetition)) % 2 == 0) {
                runOurs();
                runTheirs();
            } else {
                runTheirs();
                runOurs();
            }
        }
        timing.ourUs.push_back(ours / static_cast<double>(poses.size()));
        timing.theirUs.push_back(theirs / static_cast<double>(poses.size()));
        timing.ratios.push_back(theirs / ours);
    }
    timing.ourQueriesUs.assign(poses.size(), INFINITY);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        Query query(tree, tree);
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const double start = report::wallUs();
            collisions += query.decide(poses[i], DecideSettings::exact()).collides ? 1U : 0U;
            timing.ourQueriesUs[i] = std::min(timing.ourQueriesUs[i], report::wallUs() - start);
        }
    }
    // The answers must be used, or the compiler may leave the questions out.
    volatile std::size_t sink = collisions;
    static_cast<void>(sink);
    return timing;
}

struct Outcome {
    report::Row row;
    std::size_t disagreements = 0;  ///< beyond the borderline
    std::size_t uncertain = 0;
};

Outcome runMesh(const NamedMesh& named, const Options& options, int perMesh, int repetitions) {
    const MeshView mesh = named.mesh.view();
    const Tree tree = build(mesh);
    const FclModel model(mesh);
    const int perDistance = (perMesh + distances - 1) / distances;
    const std::vector<Pose> poses = test::zachmannPoses(tree, tree, distances, perDistance, options.seed).poses;

    const Answers answers = answer(tree, model, poses);
    Outcome outcome;
    std::vector<double> work;
    std::size_t borders = 0;
    std::size_t colliding = 0;
    double falseNegatives = 0;
    double falsePositives = 0;
    const double size = static_cast<double>((tree.upper - tree.lower).norm());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Decision& ours = answers.ours[i];
        work.push_back(static_cast<double>(ours.work));
        outcome.uncertain += ours.certain ? 0U : 1U;
        bool truth = answers.theirs[i] != 0;
        if (ours.collides != truth) {
            const double gap = clearance(mesh, mesh, poses[i], 100 * borderline * size);
            truth = gap <= 0;
            if (std::abs(gap) < borderline * size) {
                ++borders;
            } else {
                ++outcome.disagreements;
                std::cerr << named.name << ": pose " << i << " is answered " << ours.collides << " and by FCL "
                          << !ours.collides << "; clearance " << gap / size << " of the size\n";
                falseNegatives += truth && !ours.collides ? 1 : 0;
                falsePositives += !truth && ours.collides ? 1 : 0;
            }
        }
        colliding += truth ? 1U : 0U;
    }

    const Timing timing = measure(tree, model, poses, repetitions);
    const report::Quantiles units = report::quantiles(work);
    report::Row& row = outcome.row;
    row.scenario = "zachmann";
    row.mesh = named.name;
    row.triangles = mesh.triangles.size();
    row.method = "exact";
    row.peer = "FCL OBBRSS";
    row.n = poses.size();
    row.falseNegatives = falseNegatives;
    row.falsePositives = falsePositives;
    row.colliding = static_cast<double>(colliding);
    row.timeUs = report::quantiles(timing.ourQueriesUs);
    row.timeUs.mean = report::median(timing.ourUs);
    row.ratio = report::median(timing.ratios);
    row.work = {{"workMean", units.mean}, {"workP99", units.p99}};
    row.measured = {{"peerMeanUs", report::median(timing.theirUs)},
                    {"ratioSpread", report::spread(timing.ratios)},
                    {"disagreements", static_cast<double>(outcome.disagreements)},
                    {"borderline", static_cast<double>(borders)}};
    return outcome;
}

}  // namespace

report::Report runDecideSuite(const Options& options) {
    std::vector<NamedMesh> meshes;
    for (const std::string& file : options.meshes) {
        meshes.push_back(fileMesh(file));
    }
    if (meshes.empty()) {
        meshes = generatedMeshes(options.quick);
    }
    const int perMesh = options.poses.value_or(options.quick ? 1'200 : 12'000);
    const int repetitions = options.repetitions.value_or(options.quick ? 1 : 5);

    report::Report results{.suite = "decide", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    double logarithms = 0;
    double disagreements = 0;
    double uncertain = 0;
    double poses = 0;
    double leastColliding = 1;
    double mostColliding = 0;
    for (const NamedMesh& mesh : meshes) {
        std::cerr << mesh.name << " ...\n";
        const Outcome outcome = runMesh(mesh, options, perMesh, repetitions);
        results.rows.push_back(outcome.row);
        const double n = static_cast<double>(outcome.row.n);
        logarithms += std::log(outcome.row.ratio);
        disagreements += static_cast<double>(outcome.disagreements);
        uncertain += static_cast<double>(outcome.uncertain);
        poses += n;
        leastColliding = std::min(leastColliding, outcome.row.colliding / n);
        mostColliding = std::max(mostColliding, outcome.row.colliding / n);
    }
    results.claims.push_back({"disagreements with FCL beyond the borderline", disagreements, false, 0});
    results.claims.push_back({"answers that are not certain", uncertain, false, 0});
    results.claims.push_back({"least share of colliding poses of a mesh", leastColliding, true, 0.1});
    results.claims.push_back({"largest share of colliding poses of a mesh", mostColliding, false, 0.9});
    if (!options.quick) {
        results.claims.push_back({"poses compared", poses, true, 20'000});
        results.claims.push_back({"FCL's time / ours, geometric mean over the meshes",
                                  std::exp(logarithms / static_cast<double>(meshes.size())), true, 15});
    }
    return results;
}

}  // namespace grapeshot::bench
