#include "anytime_scenes.hpp"

#include <Eigen/Geometry>

#include <support/poses.hpp>

#include "comparison.hpp"
#include "gates.hpp"

namespace grapeshot::bench {

namespace {

test::PoseSet setOf(std::vector<Pose> poses) {
    const std::size_t count = poses.size();
    return {std::move(poses), std::vector<int>(count, 0), {0}};
}

/// Each vertex moved inwards along the mean normal of the triangles around it.
scenes::Mesh inwardCopy(MeshView mesh, float depth) {
    scenes::Mesh copy{{mesh.vertices.begin(), mesh.vertices.end()}, {mesh.triangles.begin(), mesh.triangles.end()}};
    std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Eigen::Vector3f& corner = mesh.vertices[t[0]];
        const Eigen::Vector3f areaNormal = (mesh.vertices[t[1]] - corner).cross(mesh.vertices[t[2]] - corner);
        for (const std::uint32_t vertex : t) {
            normals[vertex] += areaNormal;
        }
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        copy.vertices[i] -= depth * normals[i].normalized();
    }
    return copy;
}

}  // namespace

std::vector<report::Row> nestedShells(const TreeOf& mesh, int poses, std::uint64_t seed, ResumeCheck& check) {
    const float depth = 0.01F * (mesh.tree->upper - mesh.tree->lower).norm();
    const Tree inner = build(inwardCopy(mesh.tree->mesh(), depth).view());
    test::Random random(seed);
    std::vector<Pose> moved;
    for (int i = 0; i < poses; ++i) {
        // A little beside its place, so that about half of them touch.
        Pose pose;
        const auto angle = static_cast<float>(random.uniform(0, 0.003));
        pose.rotation = Eigen::AngleAxisf(angle, random.direction()).toRotationMatrix();
        pose.translation = static_cast<float>(random.uniform(0, 2)) * depth * random.direction();
        moved.push_back(pose);
    }
    const test::PoseSet set = setOf(std::move(moved));
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
