// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, section 5.1.5
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

struct OnTriangle {
    Eigen::Vector3f point;
    int feature = 6;  ///< 0..2 corner, 3..5 edge, 6 face
};

/// In double inside: the regions' borders are differences of products.
[[nodiscard]] inline OnTriangle closestOnTriangle(const MeshModel& mesh, std::uint32_t triangle,
                                                  const Eigen::Vector3f& query) {
    using Eigen::Vector3d;
    const Triangle& corner = mesh.tree.triangles[triangle];
    const Vector3d a = mesh.tree.vertices[corner[0]].cast<double>();
    const Vector3d b = mesh.tree.vertices[corner[1]].cast<double>();
    const Vector3d c = mesh.tree.vertices[corner[2]].cast<double>();
    const Vector3d p = query.cast<double>();
    const Vector3d ab = b - a;
    const Vector3d ac = c - a;
    const double d1 = ab.dot(p - a);
    const double d2 = ac.dot(p - a);
    if (d1 <= 0 && d2 <= 0) {
        return {a.cast<float>(), 0};
    }
    const double d3 = ab.dot(p - b);
    const double d4 = ac.dot(p - b);
    if (d3 >= 0 && d4 <= d3) {
        return {b.cast<float>(), 1};
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        return {(a + d1 / (d1 - d3) * ab).cast<float>(), 3};
    }
    const double d5 = ab.dot(p - c);
    const double d6 = ac.dot(p - c);
    if (d6 >= 0 && d5 <= d6) {
        return {c.cast<float>(), 2};
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        return {(a + d2 / (d2 - d6) * ac).cast<float>(), 5};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return {(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).cast<float>(), 4};
    }
    const double scale = 1 / (va + vb + vc);
    return {(a + vb * scale * ab + vc * scale * ac).cast<float>(), 6};
}

}  // namespace grapeshot::detail
