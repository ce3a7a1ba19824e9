#include <grapeshot/adb/reference/triangle_overlap.hpp>

#include <Eigen/Geometry>
#include <algorithm>

namespace grapeshot::reference {

namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Any axis will do, so a product of parallel edges, which is but rounding, does no harm.
bool apartAlong(const Eigen::Vector3d& axis, const Corners& a, const Corners& b, double size) {
    const auto [lowA, highA] = std::minmax({axis.dot(a[0]), axis.dot(a[1]), axis.dot(a[2])});
    const auto [lowB, highB] = std::minmax({axis.dot(b[0]), axis.dot(b[1]), axis.dot(b[2])});
    const double gap = std::max(lowA - highB, lowB - highA);
    return gap > 0 && gap > 1e-15 * size * axis.lpNorm<1>();
}

}  // namespace

bool trianglesOverlap(const Corners& cornersA, const Corners& cornersB) {
    Corners a;
    Corners b;
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        a[i] = cornersA[i] - cornersA[0];
        b[i] = cornersB[i] - cornersA[0];
        size = std::max({size, a[i].lpNorm<Eigen::Infinity>(), b[i].lpNorm<Eigen::Infinity>()});
    }
    const Corners edgesA{a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Corners edgesB{b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Eigen::Vector3d normalA = edgesA[0].cross(edgesA[1]);
    const Eigen::Vector3d normalB = edgesB[0].cross(edgesB[1]);
    if (apartAlong(normalA, a, b, size) || apartAlong(normalB, a, b, size)) {
        return false;
    }
    for (const Eigen::Vector3d& edgeA : edgesA) {
        for (const Eigen::Vector3d& edgeB : edgesB) {
            if (apartAlong(edgeA.cross(edgeB), a, b, size)) {
                return false;
            }
        }
    }
    // Pairs in one plane, and triangles without area. Few pairs come so far, and the first that overlaps is the last.
    const auto anyApart = [&](const auto&... axes) { return (apartAlong(axes, a, b, size) || ...); };
    const Eigen::Vector3d apart = b[0] - a[0];
    if (anyApart(apart)) {
        return false;
    }
    for (const Eigen::Vector3d& edge : {edgesA[0], edgesA[1], edgesA[2], edgesB[0], edgesB[1], edgesB[2]}) {
        const Eigen::Vector3d across = apart * edge.squaredNorm() - edge * edge.dot(apart);
        if (anyApart(edge, across, normalA.cross(edge), normalB.cross(edge))) {
            return false;
        }
    }
    for (const Eigen::Vector3d& edgeA : edgesA) {
        for (const Eigen::Vector3d& edgeB : edgesB) {
            const Eigen::Vector3d both = edgeA.cross(edgeB);
            if (anyApart(both.cross(edgeA), both.cross(edgeB))) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace grapeshot::reference
