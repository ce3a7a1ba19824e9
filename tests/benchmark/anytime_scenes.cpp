#include "anytime_scenes.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include <support/poses.hpp>

#include "comparison.hpp"
#include "gates.hpp"
#include "nested_shells.hpp"
#include "pose_sets.hpp"

namespace grapeshot::bench {

namespace {

test::PoseSet setOf(std::vector<Pose> poses) {
    const std::size_t count = poses.size();
    return {std::move(poses), std::vector<int>(count, 0), {0}};
}

}  // namespace

std::vector<report::Row> nestedShells(const TreeOf& mesh, int poses, std::uint64_t seed, ResumeCheck& check) {
    const NestedShells shells = nestedIn(*mesh.tree, 0.01, poses, seed);
    const Tree& inner = shells.inner;
    const test::PoseSet& set = shells.set;
    const Truth truth = exactTruth(*mesh.tree, inner, set.poses);
    const PosedPair where{"nested shells", mesh.name, mesh.tree->triangles.size(), set, truth};
    // FCL takes too long here.
    std::vector<report::Row> rows = compare(where,
                                            {queryPeer("exact", *mesh.tree, inner, exactShuffled()),
                                             queryPeer("hybrid", *mesh.tree, inner, hybridShuffled())},
                                            1, 0);
    constexpr std::uint64_t budgets[] = {64, 256, 1024, 4096};
    const std::vector<report::Row> atSteps =
        rowsOf(estimates(*mesh.tree, inner, set.poses, truth.collides, budgets, 1, check), "nested shells", mesh.name,
               mesh.tree->triangles.size());
    rows.insert(rows.end(), atSteps.begin(), atSteps.end());
    const std::vector<report::Row> stopped =
        rowsOf(rival("exact, else no", queryPeer("exact", *mesh.tree, inner, exactShuffled()), set.poses,
                     truth.collides, budgets, [](std::size_t, std::size_t) { return 0.49; }),
               "nested shells", mesh.name, mesh.tree->triangles.size());
    rows.insert(rows.end(), stopped.begin(), stopped.end());
    return rows;
}

std::vector<report::Row> coherentPath(const TreeOf& mesh, int steps, int repetitions, std::uint64_t seed) {
    const Tree& tree = *mesh.tree;
    test::Random random(seed);
    const Eigen::Vector3f axis = random.direction();
    const Eigen::Vector3f orbit = random.direction();
    const Eigen::Vector3f start = axis.unitOrthogonal();
    const Eigen::Vector3f middle = 0.5F * (tree.lower + tree.upper);
    const auto diameter = static_cast<float>(RelativeDistance(tree, tree).diameter());
    constexpr float turnPerStep = 0.005F;  // rad
    std::vector<Pose> path;
    for (int i = 0; i < steps; ++i) {
        const float angle = turnPerStep * static_cast<float>(i);
        Pose pose;
        pose.rotation = Eigen::AngleAxisf(1.7F * angle, axis).toRotationMatrix();
        // From deep inside each other to apart, and back, every two hundred steps.
        const float distance =
            diameter * (0.65F + 0.3F * std::sin(std::numbers::pi_v<float> * static_cast<float>(i) / 100));
        const Eigen::Vector3f place = middle + distance * (Eigen::AngleAxisf(angle, orbit) * start);
        pose.translation = place - pose.rotation * middle;
        path.push_back(pose);
    }
    const test::PoseSet set = setOf(std::move(path));
    const Truth truth = exactTruth(tree, tree, set.poses);
    DecideSettings noWitness = DecideSettings::exact();
    noWitness.tryWitness = false;
    return compare(
        {"coherent path", mesh.name, tree.triangles.size(), set, truth},
        {queryPeer("exact", tree, tree, DecideSettings::exact()), fclPeer(tree.mesh(), tree.mesh()),
         queryPeer("exact, no witness", tree, tree, noWitness), queryPeer("hybrid", tree, tree, DecideSettings())},
        repetitions);
}

std::vector<report::Row> hotReplay(const TreeOf& mesh, int poses, int replays, int repetitions, std::uint64_t seed) {
    const Tree& tree = *mesh.tree;
    std::vector<Pose> repeated;
    for (const Pose& pose : zachmannSet(tree, poses, seed).poses) {
        repeated.insert(repeated.end(), static_cast<std::size_t>(replays), pose);
    }
    const test::PoseSet set = setOf(std::move(repeated));
    const Truth truth = exactTruth(tree, tree, set.poses);
    // Without the witness: with it, a replay of a colliding pose is a single unit.
    std::vector<Peer> methods{queryPeer("exact", tree, tree, exactShuffled()),
                              queryPeer("hybrid", tree, tree, hybridShuffled())};
    for (const EstimateSetting& estimate : estimateSettings) {
        methods.push_back(queryPeer(estimate.name, tree, tree, estimate.settings()));
    }
    return compare({"hot replay", mesh.name, tree.triangles.size(), set, truth}, methods, repetitions, 0);
}

}  // namespace grapeshot::bench
