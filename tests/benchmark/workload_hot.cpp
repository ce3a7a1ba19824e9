#include "comparison.hpp"
#include "gates.hpp"
#include "pose_sets.hpp"
#include "stopped.hpp"
#include "workload_scenes.hpp"

namespace grapeshot::bench {

namespace {

test::PoseSet repeated(const test::PoseSet& set, int replays) {
    test::PoseSet result;
    result.distances = set.distances;
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
        result.poses.insert(result.poses.end(), static_cast<std::size_t>(replays), set.poses[i]);
        result.distanceIndex.insert(result.distanceIndex.end(), static_cast<std::size_t>(replays),
                                    set.distanceIndex[i]);
    }
    return result;
}

}  // namespace

std::vector<report::Row> hotRows(const TreeOf& mesh, int poses, int replays, int repetitions, std::uint64_t seed,
                                 WorkloadCheck& check) {
    const Tree& tree = *mesh.tree;
    // Without the witness: with it, a replay of a colliding pose is a single unit.
    std::vector<Peer> methods{queryPeer("exact", tree, tree, exactShuffled()), fclPeer(tree.mesh(), tree.mesh()),
                              queryPeer("hybrid", tree, tree, hybridShuffled())};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.push_back(queryPeer(estimate.name, tree, tree, estimate.settings()));
    }
    std::vector<report::Row> rows;
    const std::pair<std::string, test::PoseSet> sets[] = {
        {"hot", repeated(zachmannSet(tree, poses, seed), replays)},
        {"hot, as many shuffled", zachmannSet(tree, poses * replays, seed + 1)}};
    for (const auto& [scenario, set] : sets) {
        const Truth truth = checkedTruth(mesh.name + ", " + scenario, tree, tree, set.poses, methods[1]);
        check.disagreements += static_cast<double>(truth.disagreements);
        check.uncertain += static_cast<double>(truth.uncertain);
        check.poses += static_cast<double>(set.poses.size());
        check.colliding += static_cast<double>(truth.colliding);
        const std::vector<report::Row> more =
            compare({scenario, mesh.name, tree.triangles.size(), set, truth}, methods, repetitions);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

}  // namespace grapeshot::bench
