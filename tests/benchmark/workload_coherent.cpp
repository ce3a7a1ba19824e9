#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include <support/poses.hpp>

#include "comparison.hpp"
#include "gates.hpp"
#include "stopped.hpp"
#include "workload_scenes.hpp"

namespace grapeshot::bench {

namespace {

/// B's middle of box at an offset from that of A, which is the same mesh.
Pose placed(const Tree& tree, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& offset) {
    const Eigen::Vector3f middle = 0.5F * (tree.lower + tree.upper);
    return {rotation, middle + offset - rotation * middle};
}

/// Goes round while it swings from deep inside to apart and back every two hundred steps, turning all the time.
std::vector<Pose> orbit(const Tree& tree, int steps, test::Random& random) {
    const Eigen::Vector3f axis = random.direction();
    const Eigen::Vector3f orbitAxis = random.direction();
    const Eigen::Vector3f start = axis.unitOrthogonal();
    const auto diameter = static_cast<float>(RelativeDistance(tree, tree).diameter());
    constexpr float turnPerStep = 0.005F;  // rad
    std::vector<Pose> path;
    for (int i = 0; i < steps; ++i) {
        const float angle = turnPerStep * static_cast<float>(i);
        const float distance =
            diameter * (0.65F + 0.3F * std::sin(std::numbers::pi_v<float> * static_cast<float>(i) / 100));
        path.push_back(placed(tree, Eigen::AngleAxisf(1.7F * angle, axis).toRotationMatrix(),
                              distance * (Eigen::AngleAxisf(angle, orbitAxis) * start)));
    }
    return path;
}

/// Flies by on a straight line, 1 % of the diameter and 2 degrees a step, for four seconds at 60 Hz; then on another.
std::vector<Pose> flyby(const Tree& tree, int steps, test::Random& random) {
    constexpr int stepsPerLine = 240;
    constexpr float turnPerStep = 2 * std::numbers::pi_v<float> / 180;  // rad
    const auto diameter = static_cast<float>(RelativeDistance(tree, tree).diameter());
    std::vector<Pose> path;
    while (static_cast<int>(path.size()) < steps) {
        const Eigen::Matrix3f rotation = random.rotation();
        const Eigen::Vector3f axis = random.direction();
        const Eigen::Vector3f along = random.direction();
        const Eigen::Vector3f beside =
            Eigen::AngleAxisf(static_cast<float>(random.uniform(0, 2 * std::numbers::pi)), along) *
            along.unitOrthogonal() * static_cast<float>(random.uniform(0, 0.9)) * diameter;
        for (int i = 0; i < stepsPerLine && static_cast<int>(path.size()) < steps; ++i) {
            const float place = diameter * 0.01F * (static_cast<float>(i) - 0.5F * stepsPerLine);
            path.push_back(
                placed(tree, Eigen::AngleAxisf(turnPerStep * static_cast<float>(i), axis).toRotationMatrix() * rotation,
                       beside + place * along));
        }
    }
    return path;
}

}  // namespace

std::vector<report::Row> coherentRows(const TreeOf& mesh, int steps, int repetitions, std::uint64_t seed,
                                      WorkloadCheck& check) {
    const Tree& tree = *mesh.tree;
    const Peer fcl = fclPeer(tree.mesh(), tree.mesh());
    test::Random random(seed);
    std::vector<report::Row> rows;
    const std::pair<std::string, std::vector<Pose>> paths[] = {{"coherent, orbit", orbit(tree, steps, random)},
                                                               {"coherent, flyby", flyby(tree, steps, random)}};
    for (const auto& [scenario, path] : paths) {
        const test::PoseSet set{path, std::vector<int>(path.size(), 0), {0}};
        const Truth truth = checkedTruth(mesh.name + ", " + scenario, tree, tree, path, fcl);
        check.disagreements += static_cast<double>(truth.disagreements);
        check.uncertain += static_cast<double>(truth.uncertain);
        check.poses += static_cast<double>(path.size());
        check.colliding += static_cast<double>(truth.colliding);
        const std::vector<report::Row> more = compare({scenario, mesh.name, tree.triangles.size(), set, truth},
                                                      {queryPeer("exact", tree, tree, DecideSettings::exact()), fcl,
                                                       queryPeer("exact, no witness", tree, tree, exactShuffled()),
                                                       queryPeer("hybrid", tree, tree, DecideSettings()),
                                                       queryPeer("hybrid, no witness", tree, tree, hybridShuffled())},
                                                      repetitions);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

}  // namespace grapeshot::bench
