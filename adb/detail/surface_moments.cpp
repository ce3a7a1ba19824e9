#include <grapeshot/adb/detail/surface_moments.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace grapeshot::detail {
namespace {

float narrowed(double value) {
    constexpr double largest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -largest, largest));
}

}  // namespace

SurfaceMoments momentsOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    SurfaceMoments out;
    out.normalSum = 0.5 * (b - a).cross(c - a);
    out.area = out.normalSum.norm();
    out.mean = (a + b + c) / 3.0;
    // The second moment of a uniform triangle is that of its corners with a twelfth of its area each.
    for (const Eigen::Vector3d* corner : {&a, &b, &c}) {
        const Eigen::Vector3d d = *corner - out.mean;
        out.covariance += d * d.transpose() / 12.0;
    }
    return out;
}

SurfaceMoments sum(const SurfaceMoments* pieces, int count) {
    SurfaceMoments out;
    for (int i = 0; i < count; ++i) {
        out.area += pieces[i].area;
        out.normalSum += pieces[i].normalSum;
    }
    const auto weight = [&](int i) { return out.area > 0 ? pieces[i].area / out.area : 1.0 / count; };
    // About the first piece: far from the origin the plain sum would lose what the covariance needs.
    for (int i = 1; i < count; ++i) {
        out.mean += weight(i) * (pieces[i].mean - pieces[0].mean);
    }
    out.mean += pieces[0].mean;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d d = pieces[i].mean - out.mean;
        out.covariance += weight(i) * (pieces[i].covariance + d * d.transpose());
    }
    return out;
}

void store(const SurfaceMoments& moments, NodeMoments& out, int slot) {
    out.area[slot] = narrowed(moments.area);
    for (int axis = 0; axis < 3; ++axis) {
        out.mean[axis][slot] = narrowed(moments.mean[axis]);
        out.normalSum[axis][slot] = narrowed(moments.normalSum[axis]);
        out.covariance[axis][slot] = narrowed(moments.covariance(axis, axis));
    }
    out.covariance[3][slot] = narrowed(moments.covariance(0, 1));
    out.covariance[4][slot] = narrowed(moments.covariance(0, 2));
    out.covariance[5][slot] = narrowed(moments.covariance(1, 2));
}

}  // namespace grapeshot::detail
