// Bullet shapes from meshes.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include <scenes/shapes.hpp>

namespace grapeshot::scenes::detail {

/// Bullet reads the mesh's own arrays, which must stay where they are.
struct MeshShape {
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btCollisionShape> shape;
};

MeshShape gimpactShape(const Mesh& mesh, double margin);
MeshShape bvhShape(const Mesh& mesh, double margin);
/// The hull's own vertices alone: Bullet's support function is linear in their number.
MeshShape hullShape(const Mesh& mesh, double margin);

}  // namespace grapeshot::scenes::detail
