// The closest point of a mesh's triangle.
#pragma once

#include <cstdint>

#include <grapeshot/core/detail/closest_on_triangle.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>

namespace grapeshot::detail {

struct OnTriangle {
    Eigen::Vector3f point;
    int feature = 6;  ///< 0..2 corner, 3..5 edge, 6 face
};

[[nodiscard]] inline OnTriangle closestOnTriangle(const MeshModel& mesh, std::uint32_t triangle,
                                                  const Eigen::Vector3f& query) {
    const Triangle& corner = mesh.tree.triangles[triangle];
    const PointOnTriangle on =
        closestOnTriangle(mesh.tree.vertices[corner[0]].cast<double>(), mesh.tree.vertices[corner[1]].cast<double>(),
                          mesh.tree.vertices[corner[2]].cast<double>(), query.cast<double>());
    return {on.point.cast<float>(), on.feature};
}

}  // namespace grapeshot::detail
