#include <grapeshot/adb/reference/polygon_clipping.hpp>

#include <Eigen/Geometry>
#include <algorithm>

namespace grapeshot::reference {

namespace {

/// Keeps sign * x[axis] >= sign * bound.
ConvexPolygon cutToHalfSpace(const ConvexPolygon& polygon, int axis, double bound, double sign) {
    ConvexPolygon result;
    for (int i = 0; i < polygon.count; ++i) {
        const Eigen::Vector3d& from = polygon.corners[static_cast<std::size_t>(i)];
        const Eigen::Vector3d& to = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
        const double height = sign * (from[axis] - bound);
        const double nextHeight = sign * (to[axis] - bound);
        if (height >= 0) {
            result.add(from);
        }
        if ((height > 0 && nextHeight < 0) || (height < 0 && nextHeight > 0)) {
            Eigen::Vector3d crossing = from + height / (height - nextHeight) * (to - from);
            crossing[axis] = bound;
            result.add(crossing);
        }
    }
    return result;
}

}  // namespace

double area(const ConvexPolygon& polygon) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 2; i < static_cast<std::size_t>(polygon.count); ++i) {
        sum += (polygon.corners[i - 1] - polygon.corners[0]).cross(polygon.corners[i] - polygon.corners[0]);
    }
    return 0.5 * sum.norm();
}

ConvexPolygon cutToSlab(const ConvexPolygon& polygon, int axis, double low, double high, bool last) {
    ConvexPolygon result = cutToHalfSpace(cutToHalfSpace(polygon, axis, low, 1), axis, high, -1);
    const auto end = result.corners.begin() + result.count;
    if (!last && std::all_of(result.corners.begin(), end, [&](const auto& corner) { return corner[axis] == high; })) {
        result.count = 0;
    }
    return result;
}

}  // namespace grapeshot::reference
