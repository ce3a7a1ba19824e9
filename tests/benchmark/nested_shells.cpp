#include "nested_shells.hpp"

#include <Eigen/Geometry>

#include <scenes/shapes.hpp>

#include "comparison.hpp"
#include "gates.hpp"
#include "stopped.hpp"
#include "truth.hpp"

namespace grapeshot::bench {

namespace {

struct Gap {
    const char* scenario;
    double size;  ///< in diagonals of the box
};
constexpr Gap gaps[] = {{"nested, 0.25 %", 0.0025}, {"nested, 1 %", 0.01}, {"nested, 5 %", 0.05}};

/// FCL takes milliseconds a pose for this many already.
constexpr std::size_t mostForFcl = 5'000;

}  // namespace

NestedShells nestedIn(const Tree& tree, double gap, int poses, std::uint64_t seed) {
    const float depth = static_cast<float>(gap) * (tree.upper - tree.lower).norm();
    NestedShells shells{build(scenes::inwardCopy({tree.vertices, tree.triangles}, depth).view()), {{}, {}, {gap}}};
    test::Random random(seed);
    for (int i = 0; i < poses; ++i) {
        Pose& pose = shells.set.poses.emplace_back();
        const auto angle = static_cast<float>(random.uniform(0, 0.003));
        pose.rotation = Eigen::AngleAxisf(angle, random.direction()).toRotationMatrix();
        pose.translation = static_cast<float>(random.uniform(0, 2)) * depth * random.direction();
        shells.set.distanceIndex.push_back(0);
    }
    return shells;
}

std::vector<report::Row> nestedRows(const std::string& name, const Tree& tree, int poses, int repetitions,
                                    std::uint64_t seed) {
    std::vector<report::Row> rows;
    for (const Gap& gap : gaps) {
        const NestedShells shells = nestedIn(tree, gap.size, poses, seed);
        const Truth truth = exactTruth(tree, shells.inner, shells.set.poses);
        std::vector<Peer> methods{queryPeer("exact", tree, shells.inner, exactShuffled()),
                                  queryPeer("hybrid", tree, shells.inner, hybridShuffled())};
        const bool withFcl = tree.triangles.size() <= mostForFcl;
        if (withFcl) {
            methods.push_back(fclPeer(tree.mesh(), shells.inner.mesh()));
        }
        const std::vector<report::Row> more = compare({gap.scenario, name, tree.triangles.size(), shells.set, truth},
                                                      methods, repetitions, withFcl ? 2 : 0);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

}  // namespace grapeshot::bench
