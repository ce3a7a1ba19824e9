// Everything that is built once per mesh and shared by all bodies that use it.
#pragma once

#include <cstdint>
#include <memory>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/topology.hpp>

namespace grapeshot {

/// Sense of "collide".
enum class Interior {
    surface,  ///< only surfaces; a body inside another is free
    solid,    ///< closed meshes: one inside the other collides
};

struct MeshModel {
    Tree tree;
    Topology topology;
    MeshReport report;
    /// Angle-weighted unit normal per welded vertex (zero where it cancels): tells inside from outside at corners.
    /// Baerentzen, Aanaes: Signed Distance Computation Using the Angle Weighted Pseudonormal, 2005.
    std::vector<Eigen::Vector3f> vertexNormals;
    /// Unit normal per triangle; zero for degenerate ones.
    std::vector<Eigen::Vector3f> triangleNormals;
    /// Closed and not inside out: inside and outside mean something, so penetration has a sign.
    bool solid = false;
};

/// @throws Error as `build` does
[[nodiscard]] MeshModel makeModel(MeshView mesh, const BuildSettings& settings = {});

/// Moves the model to new vertex positions; topology stays. @throws Error as `refit` does; unchanged then.
void refit(MeshModel& model, std::span<const Eigen::Vector3f> vertices);

}  // namespace grapeshot
