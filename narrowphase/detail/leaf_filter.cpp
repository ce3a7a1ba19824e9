#include <grapeshot/narrowphase/detail/leaf_filter.hpp>

#include <algorithm>

namespace grapeshot::detail {
namespace {

struct Box {
    Eigen::Vector3f center = Eigen::Vector3f::Zero();
    Eigen::Vector3f half = Eigen::Vector3f::Zero();
};

/// Leaf blocks keep no box; unused lanes repeat the first triangle, so all twelve corners count.
Box boxOf(const LeafBlock& leaf) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto& c = leaf.corner;
        float low[4];
        float high[4];
        for (int lane = 0; lane < 4; ++lane) {
            low[lane] = std::min(std::min(c[0][axis][lane], c[1][axis][lane]), c[2][axis][lane]);
            high[lane] = std::max(std::max(c[0][axis][lane], c[1][axis][lane]), c[2][axis][lane]);
        }
        const float lowest = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
        const float highest = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
        box.center[axis] = 0.5F * (lowest + highest);
        box.half[axis] = 0.5F * (highest - lowest);
    }
    return box;
}

}  // namespace

void nearPairs(const Tree& a, const Tree& b, const Pose& bInA, std::span<const LeafPair> pairs, float maxDistance,
               std::vector<LeafPair>& out) {
    out.clear();
    const Eigen::Matrix3f turn = bInA.rotation.cwiseAbs();
    // What rounding, and a rotation that is only nearly one, can take away.
    const float limit = maxDistance + 4e-6F * (a.radius + b.radius + bInA.translation.norm());
    std::uint32_t leafA = 0xffffffffU;
    Box boxA;
    for (const LeafPair& pair : pairs) {
        if (pair.leafA != leafA) {
            leafA = pair.leafA;
            boxA = boxOf(a.leaves[leafA]);
        }
        const Box boxB = boxOf(b.leaves[pair.leafB]);
        const Eigen::Vector3f offset = apply(bInA, boxB.center) - boxA.center;
        const Eigen::Vector3f apartInA = offset.cwiseAbs() - (boxA.half + turn * boxB.half);
        if (apartInA.cwiseMax(0.0F).squaredNorm() > limit * limit) {
            continue;
        }
        const Eigen::Vector3f apartInB =
            (bInA.rotation.transpose() * offset).cwiseAbs() - (boxB.half + turn.transpose() * boxA.half);
        if (apartInB.cwiseMax(0.0F).squaredNorm() <= limit * limit) {
            out.push_back(pair);
        }
    }
}

}  // namespace grapeshot::detail
