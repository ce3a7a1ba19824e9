#include <grapeshot/narrowphase/detail/leaf_filter.hpp>

#include <algorithm>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

namespace grapeshot::detail {

std::uint64_t nearPairs(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const LeafPair> pairs,
                        float maxDistance, std::uint64_t mostWork, std::vector<LeafPair>& out) {
    using Eigen::Vector3f;
    out.clear();
    std::uint64_t work = 0;
    const Eigen::Matrix3f turn = bInA.rotation.cwiseAbs();
    const bool twoSided = !a.solid || !b.solid;
    // What rounding, and a rotation that is only nearly one, can take away.
    const float rounding = 4e-6F * (a.tree.radius + b.tree.radius + bInA.translation.norm());
    const float limit = maxDistance + rounding;
    for (const LeafPair& pair : pairs) {
        const LeafShape& leafA = a.leafShapes[pair.leafA];
        const LeafShape& leafB = b.leafShapes[pair.leafB];
        const Vector3f offset = bInA.rotation * leafB.center + bInA.translation - leafA.center;
        const Vector3f apartInA = offset.cwiseAbs() - (leafA.half + turn * leafB.half);
        if (apartInA.cwiseMax(0.0F).squaredNorm() > limit * limit) {
            continue;
        }
        const Vector3f offsetInB = bInA.rotation.transpose() * offset;
        const Vector3f apartInB = offsetInB.cwiseAbs() - (leafB.half + turn.transpose() * leafA.half);
        if (apartInB.cwiseMax(0.0F).squaredNorm() > limit * limit) {
            continue;
        }
        if (!faceEachOther(leafA, leafB, bInA.rotation * leafB.axis, twoSided)) {
            if (std::max(apartInA.maxCoeff(), apartInB.maxCoeff()) > rounding) {
                continue;
            }
            if (work < mostWork) {
                ++work;
                if (overlapsLeaves(a.tree.leaves[pair.leafA].corner, b.tree.leaves[pair.leafB].corner, bInA) == 0) {
                    continue;
                }
            }
        }
        out.push_back(pair);
    }
    return work;
}

}  // namespace grapeshot::detail
