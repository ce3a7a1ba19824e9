// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, section 5.1.5
#pragma once

#include <Eigen/Core>

namespace grapeshot::detail {

struct PointOnTriangle {
    Eigen::Vector3d point;
    int feature = 6;  ///< 0..2 corner, 3..5 edge (edge e runs from corner e-3 to the next), 6 face
};

/// In double: the regions' borders are differences of products.
[[nodiscard]] inline PointOnTriangle closestOnTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                       const Eigen::Vector3d& c, const Eigen::Vector3d& p) {
    using Eigen::Vector3d;
    const Vector3d ab = b - a;
    const Vector3d ac = c - a;
    const double d1 = ab.dot(p - a);
    const double d2 = ac.dot(p - a);
    if (d1 <= 0 && d2 <= 0) {
        return {a, 0};
    }
    const double d3 = ab.dot(p - b);
    const double d4 = ac.dot(p - b);
    if (d3 >= 0 && d4 <= d3) {
        return {b, 1};
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        return {a + d1 / (d1 - d3) * ab, 3};
    }
    const double d5 = ab.dot(p - c);
    const double d6 = ac.dot(p - c);
    if (d6 >= 0 && d5 <= d6) {
        return {c, 2};
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        return {a + d2 / (d2 - d6) * ac, 5};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 4};
    }
    const double scale = 1 / (va + vb + vc);
    return {a + vb * scale * ab + vc * scale * ac, 6};
}

}  // namespace grapeshot::detail
