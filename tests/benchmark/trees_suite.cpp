#include "trees_suite.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <grapeshot/adb/tree.hpp>

#include "comparison.hpp"
#include "deformation.hpp"
#include "fcl_model.hpp"
#include "meshes.hpp"
#include "pose_sets.hpp"
#include "stopped.hpp"

namespace grapeshot::bench {

namespace {

constexpr const char* fclName = "FCL OBBRSS";

/// So small a mesh is built so many times for one measurement, or the clock would be what is measured.
std::size_t timesPerMeasurement(std::size_t triangles) {
    return std::max<std::size_t>(1, 20'000 / triangles);
}

report::Row rowOf(const char* scenario, const NamedMesh& mesh, const char* method) {
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh.name;
    row.triangles = mesh.mesh.triangles.size();
    row.method = method;
    row.peer = fclName;
    return row;
}

/// Rows of ours and of FCL, which have been timed so often.
std::vector<report::Row> timedRows(const char* scenario, const NamedMesh& mesh, const Contender& ours,
                                   const Contender& fcl, int repetitions) {
    const std::size_t count = timesPerMeasurement(mesh.mesh.triangles.size());
    const std::vector<Times> times = interleaved({ours, fcl}, count, repetitions);
    std::vector<report::Row> rows{rowOf(scenario, mesh, "grapeshot"), rowOf(scenario, mesh, fclName)};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].n = count * static_cast<std::size_t>(repetitions);
        rows[i].timeUs = report::quantiles(times[i]);
        rows[i].timeUs.mean = report::median(times[i]);
        const std::vector<double> toFcl = ratios(times[i], times[1]);
        rows[i].ratio = report::median(toFcl);
        rows[i].measured = {{"usPerTriangle", rows[i].timeUs.mean / static_cast<double>(rows[i].triangles)},
                            {"ratioSpread", report::spread(toFcl)}};
    }
    return rows;
}

template <class Entry>
double bytesOf(const std::vector<Entry>& entries) {
    return static_cast<double>(entries.capacity() * sizeof(Entry));
}

/// Bytes per triangle. "beyondMesh": all but vertices and indices.
std::vector<report::Row> memoryRows(const NamedMesh& mesh, const Tree& tree, const FclModel& model) {
    const auto triangles = static_cast<double>(mesh.mesh.triangles.size());
    const double nodes = bytesOf(tree.nodes) / triangles;
    const double distributions = bytesOf(tree.distributions) / triangles;
    const double leaves = bytesOf(tree.leaves) / triangles;
    const double ourMesh = (bytesOf(tree.vertices) + bytesOf(tree.triangles)) / triangles;
    const double beyond = nodes + distributions + leaves;
    const FclModel::Bytes fcl = model.bytes();
    const double fclNodes = static_cast<double>(fcl.nodes) / triangles;
    const double fclMesh = static_cast<double>(fcl.mesh) / triangles;
    report::Row ours = rowOf("memory", mesh, "grapeshot");
    ours.n = 1;
    ours.measured = {{"nodesB", nodes},
                     {"distributionsB", distributions},
                     {"leavesB", leaves},
                     {"beyondMeshB", beyond},
                     {"meshB", ourMesh},
                     {"totalB", beyond + ourMesh},
                     {"peerTotalOverOurs", (fclNodes + fclMesh) / (beyond + ourMesh)}};
    report::Row theirs = rowOf("memory", mesh, fclName);
    theirs.n = 1;
    theirs.measured = {
        {"nodesB", fclNodes}, {"beyondMeshB", fclNodes}, {"meshB", fclMesh}, {"totalB", fclNodes + fclMesh}};
    return {ours, theirs};
}

std::vector<report::Row> buildRows(const NamedMesh& mesh, int repetitions) {
    const FclPoints points(mesh.mesh.vertices);
    const FclTriangles triangles(mesh.mesh.triangles);
    const Contender ours = [&](std::size_t begin, std::size_t end) {
        std::size_t nodes = 0;
        for (; begin < end; ++begin) {
            nodes += build(mesh.mesh.view()).nodes.size();
        }
        return nodes;
    };
    const Contender fcl = [&](std::size_t begin, std::size_t end) {
        std::size_t bytes = 0;
        for (; begin < end; ++begin) {
            bytes += FclModel(points, triangles).bytes().nodes;
        }
        return bytes;
    };
    return timedRows("build", mesh, ours, fcl, repetitions);
}

struct Check {
    double disagreements = 0, unlikeRebuilt = 0, uncertain = 0, poses = 0, colliding = 0;
};

double meanWork(const Tree& tree, const std::vector<Pose>& poses) {
    Query query(tree, tree);
    double work = 0;
    for (const Pose& pose : poses) {
        work += static_cast<double>(query.decide(pose, exactShuffled()).work);
    }
    return work / static_cast<double>(poses.size());
}

/// There and back: every refit moves the vertices. In the end both are twisted, and asked.
std::vector<report::Row> refitRows(const NamedMesh& mesh, Tree& tree, FclModel& model, int poses, int repetitions,
                                   std::uint64_t seed, Check& check) {
    const std::vector<Eigen::Vector3f> shapes[] = {mesh.mesh.vertices, twisted(mesh.mesh.vertices)};
    const FclPoints fclShapes[] = {FclPoints(shapes[0]), FclPoints(shapes[1])};
    std::size_t ourTurn = 0;
    std::size_t fclTurn = 0;
    const Contender ours = [&](std::size_t begin, std::size_t end) {
        for (; begin < end; ++begin) {
            refit(tree, shapes[++ourTurn % 2]);
        }
        return tree.nodes.size();
    };
    const Contender fcl = [&](std::size_t begin, std::size_t end) {
        for (; begin < end; ++begin) {
            model.refit(fclShapes[++fclTurn % 2]);
        }
        return end;
    };
    std::vector<report::Row> rows = timedRows("refit", mesh, ours, fcl, repetitions);
    refit(tree, shapes[1]);
    model.refit(fclShapes[1]);
    const Tree rebuilt = build(tree.mesh());
    const std::vector<Pose> asked = zachmannSet(tree, poses, seed).poses;
    const Truth truth = checkedTruth(mesh.name + ", refit", tree, tree, asked, fclPeer(model, model));
    const Truth anew = exactTruth(rebuilt, rebuilt, asked);
    double unlikeRebuilt = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        unlikeRebuilt += truth.collides[i] != anew.collides[i] ? 1 : 0;
    }
    check.disagreements += static_cast<double>(truth.disagreements);
    check.unlikeRebuilt += unlikeRebuilt;
    check.uncertain += static_cast<double>(truth.uncertain);
    check.poses += static_cast<double>(asked.size());
    check.colliding += static_cast<double>(truth.colliding);
    rows.front().work = {{"workMean", meanWork(tree, asked)}, {"workMeanRebuilt", meanWork(rebuilt, asked)}};
    rows.front().measured.insert(rows.front().measured.end(),
                                 {{"asked", static_cast<double>(asked.size())},
                                  {"disagreements", static_cast<double>(truth.disagreements)},
                                  {"borderline", static_cast<double>(truth.borderline)},
                                  {"unlikeRebuilt", unlikeRebuilt}});
    rows.front().colliding = static_cast<double>(truth.colliding);
    return rows;
}

/// Geometric mean of the ratios, or the means of what is measured.
report::Row meanRow(const std::vector<report::Row>& rows, const std::string& scenario) {
    report::Row mean;
    mean.scenario = scenario;
    mean.method = "grapeshot";
    mean.peer = fclName;
    std::vector<double> ratios;
    for (const report::Row& row : rows) {
        if (row.scenario != scenario || row.method != mean.method) {
            continue;
        }
        ++mean.n;
        ratios.push_back(row.ratio);
        for (const auto& [name, value] : row.measured) {
            const auto found = std::ranges::find(mean.measured, name, [](const auto& entry) { return entry.first; });
            if (found == mean.measured.end()) {
                mean.measured.emplace_back(name, value);
            } else {
                found->second += value;
            }
        }
    }
    mean.mesh = "mean of " + std::to_string(mean.n);
    mean.ratio = report::geometricMean(ratios);
    for (auto& [name, value] : mean.measured) {
        value /= static_cast<double>(mean.n);
    }
    return mean;
}

}  // namespace

report::Report runTreesSuite(const Options& options) {
    const bool quick = options.quick;
    const int poses = options.poses.value_or(quick ? 240 : 2'400);
    const int repetitions = options.repetitions.value_or(quick ? 1 : 7);
    report::Report results{.suite = "trees", .seed = options.seed, .quick = quick, .rows = {}, .claims = {}};
    Check check;
    for (const NamedMesh& mesh : reportedMeshes(options.meshes, quick)) {
        std::cerr << mesh.name << " ...\n";
        const auto add = [&](const std::vector<report::Row>& rows) {
            results.rows.insert(results.rows.end(), rows.begin(), rows.end());
        };
        add(buildRows(mesh, repetitions));
        Tree tree = build(mesh.mesh.view());
        FclModel model(mesh.mesh.view());
        add(memoryRows(mesh, tree, model));
        add(refitRows(mesh, tree, model, poses, repetitions, options.seed, check));
    }
    for (const char* scenario : {"memory", "build", "refit"}) {
        results.rows.push_back(meanRow(results.rows, scenario));
    }
    const double colliding = check.colliding / check.poses;
    results.claims.push_back(
        {"after a refit: disagreements with FCL beyond the borderline", check.disagreements, false, 0});
    results.claims.push_back({"after a refit: other answers than a new tree's", check.unlikeRebuilt, false, 0});
    results.claims.push_back({"after a refit: answers that are not certain", check.uncertain, false, 0});
    results.claims.push_back({"share of colliding poses", colliding, true, 0.1});
    results.claims.push_back({"share of colliding poses", colliding, false, 0.9});
    return results;
}

}  // namespace grapeshot::bench
