#include "anytime_scenes.hpp"

#include <Eigen/Geometry>

#include <support/poses.hpp>

#include "comparison.hpp"
#include "gates.hpp"
#include "nested_shells.hpp"

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

}  // namespace grapeshot::bench
