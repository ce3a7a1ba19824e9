// Surfaces in motion within one step, and what the slow truth says of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/continuous.hpp>
#include <grapeshot/scf/detail/impact_search.hpp>

#include <scenes/shapes.hpp>
#include <support/impact_oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {

inline std::vector<Eigen::Vector3f> placed(const scenes::Mesh& mesh, const Pose& pose) {
    std::vector<Eigen::Vector3f> moved;
    moved.reserve(mesh.vertices.size());
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
        moved.push_back(apply(pose, vertex));
    }
    return moved;
}

/// A mesh and both ends of its step.
struct MovingBody {
    scenes::Mesh mesh;
    std::vector<Eigen::Vector3f> before, now;
    [[nodiscard]] SurfaceMotion motion(const Stretch& stretch = Stretch::measured()) const {
        return {before, now, {}, stretch, {}};
    }
    [[nodiscard]] MovingMesh exact() const { return {mesh.triangles, before, now}; }
};

/// At a random place, about `distance` away, on the way towards the middle or past it, bent while it goes.
inline MovingBody passingBody(const scenes::Mesh& mesh, double distance, Random& random) {
    MovingBody body{mesh, {}, {}};
    const Eigen::Vector3f side = random.direction();
    const auto away = static_cast<float>(distance);
    const auto aside = static_cast<float>(random.uniform(0, 1.2));
    const auto past = static_cast<float>(random.uniform(-1, 1));
    const Pose from{random.rotation(), away * side};
    body.before = placed(mesh, from);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Eigen::Vector3f bent = 0.1F * std::sin(3 * mesh.vertices[i][0]) * Eigen::Vector3f::UnitY();
        body.now.push_back(body.before[i] + bent - (1 + past) * away * side +
                           aside * Eigen::Vector3f(side[1], -side[0], 0.2F));
    }
    return body;
}

/// Two bumpy spheres that pass or meet, and their trees.
struct PassingPair {
    explicit PassingPair(int frequency = 8)
        : meshA(scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, frequency, 3), 1)),
          meshB(scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, frequency, 4), 1)) {}
    scenes::Mesh meshA, meshB;
    BallTree a = buildBallTree(meshA.view());
    BallTree b = buildBallTree(meshB.view());

    struct Event {
        MovingBody a, b;
    };
    [[nodiscard]] Event event(std::uint64_t seed) const {
        Random random(seed);
        return {passingBody(meshA, 0.1, random), passingBody(meshB, random.uniform(0.9, 2.5), random)};
    }
};

/// How many of the pairs that wait hold one of the impacts?
inline std::uint64_t waitingWith(const std::vector<TriangleImpact>& impacts, const BallTree& a, const BallTree& b,
                                 const detail::ImpactFront& front) {
    const auto below = [](const BallTree& tree, BallRef root) {
        std::vector<char> isBelow(tree.surface.triangles.size(), 0);
        std::vector<BallRef> open{root};
        while (!open.empty()) {
            const BallRef ref = open.back();
            open.pop_back();
            if (isBallLeaf(ref)) {
                const BallLeaf& leaf = tree.leaves[ballIndex(ref)];
                for (std::uint32_t i = 0; i < leaf.count; ++i) {
                    isBelow[leaf.triangle[i]] = 1;
                }
                continue;
            }
            const BallNode& node = tree.nodes[ballIndex(ref)];
            open.insert(open.end(), node.child, node.child + node.count);
        }
        return isBelow;
    };
    std::uint64_t count = 0;
    for (const detail::WaitingPair& pair : front.pieces) {
        const std::vector<char> belowA = below(a, pair.a);
        const std::vector<char> belowB = below(b, pair.b);
        count += std::ranges::any_of(
            impacts, [&](const TriangleImpact& impact) { return belowA[impact.a] != 0 && belowB[impact.b] != 0; });
    }
    for (const detail::WaitingPair& pair : front.triangles) {
        const std::uint32_t i = a.leaves[pair.a >> 4U].triangle[pair.a & 15U];
        const std::uint32_t j = b.leaves[pair.b >> 4U].triangle[pair.b & 15U];
        count +=
            std::ranges::any_of(impacts, [&](const TriangleImpact& impact) { return impact.a == i && impact.b == j; });
    }
    return count;
}

inline constexpr ImpactSettings fineSettings{.tolerance = 1e-6F};

}  // namespace grapeshot::test
