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
        float low = leaf.corner[0][axis][0];
        float high = low;
        for (const auto& corner : leaf.corner) {
            for (const float value : corner[axis]) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
        }
        box.center[axis] = 0.5F * (low + high);
        box.half[axis] = 0.5F * (high - low);
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
        const Eigen::Vector3f half = boxA.half + turn * boxB.half;
        const Eigen::Vector3f apart = (apply(bInA, boxB.center) - boxA.center).cwiseAbs() - half;
        if (apart.cwiseMax(0.0F).squaredNorm() <= limit * limit) {
            out.push_back(pair);
        }
    }
}

}  // namespace grapeshot::detail
