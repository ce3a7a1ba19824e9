// A mesh as Bullet's mesh shapes read it.
#pragma once

#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <memory>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::scenes {

/// One part; points into the mesh, which must stay where it is.
[[nodiscard]] std::unique_ptr<btTriangleIndexVertexArray> arraysOf(MeshView mesh);

}  // namespace grapeshot::scenes
