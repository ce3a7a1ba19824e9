// Pairs of meshes and poses on which every law of this folder is checked.
#pragma once

#include <string>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {

struct LawPair {
    std::string name;
    scenes::Mesh a, b;
};

/// Alike and unlike, closed and open, coarse and fine.
inline std::vector<LawPair> lawPairs() {
    using namespace scenes;
    return {{"bumpySpheres", bumpySphere(1.0F, 0.3F, 6, 9, 5), bumpySphere(1.0F, 0.2F, 8, 7, 6)},
            {"gearAndKnot", gear(1.0F, 0.15F, 0.3F, 0.4F, 11, 2), torusKnot(2, 3, 0.8F, 0.35F, 0.15F, 90, 10)},
            {"cupAndComb", cup(0.8F, 0.1F, 1.2F, 24, 8), comb(5, 0.6F, 0.3F, 0.2F, 2)},
            {"boxOnGrid", box(Eigen::Vector3f(0.4F, 0.3F, 0.5F), 3), grid(1.5F, 1.5F, 12, 12)}};
}

/// The mesh after a rigid motion of its vertices.
inline scenes::Mesh movedBy(scenes::Mesh mesh, const Pose& motion) {
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex = apply(motion, vertex);
    }
    return mesh;
}

inline float sizeOf(const Tree& tree) {
    return (tree.upper - tree.lower).norm();
}

inline std::vector<Pose> lawPoses(const Tree& a, const Tree& b, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < count; ++i) {
        poses.push_back(randomPose(a, b, random));
    }
    return poses;
}

/// B slides and turns along a smooth path through A and out again: one pose per step.
inline std::vector<Pose> lawPath(const Tree& a, const Tree& b, int steps, std::uint64_t seed) {
    Random random(seed);
    const Eigen::Vector3f direction = random.direction();
    const Eigen::Vector3f axis = random.direction();
    const Eigen::Matrix3f start = random.rotation();
    const float reach = 0.5F * (sizeOf(a) + sizeOf(b));
    std::vector<Pose> path;
    for (int i = 0; i < steps; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(steps - 1);
        const float angle = 0.8F * t;
        Eigen::Matrix3f cross;
        cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
        const Eigen::Matrix3f turn =
            Eigen::Matrix3f::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * (cross * cross);
        path.push_back({turn * start, (0.75F - 0.6F * t) * reach * direction});
    }
    return path;
}

}  // namespace grapeshot::test
