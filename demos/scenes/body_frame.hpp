// Where a mesh's mass is: centre, principal axes and inertia, in double precision.
#pragma once

#include <Eigen/Core>

#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

/// A closed mesh is solid of even density, any other a shell of even thickness.
struct BodyFrame {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();       ///< of mass, mesh frame, m
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();     ///< columns: principal axes in the mesh frame, right-handed
    Eigen::Vector3d unitInertia = Eigen::Vector3d::Ones();  ///< about those axes, for a mass of 1 kg, m^2
    bool solid = true;
};

[[nodiscard]] BodyFrame bodyFrame(const Mesh& mesh);

/// The same surface seen from its body frame: centre of mass at the origin, principal axes along x, y, z.
[[nodiscard]] Mesh inBodyFrame(Mesh mesh, const BodyFrame& frame);

}  // namespace grapeshot::scenes
