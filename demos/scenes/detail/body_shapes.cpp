#include "body_shapes.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <scenes/triangle_arrays.hpp>

namespace grapeshot::scenes::detail {

MeshShape gimpactShape(const Mesh& mesh, double margin) {
    MeshShape result{arraysOf(mesh.view()), nullptr};
    auto shape = std::make_unique<btGImpactMeshShape>(result.arrays.get());
    shape->setMargin(static_cast<btScalar>(margin));
    shape->updateBound();
    result.shape = std::move(shape);
    return result;
}

MeshShape bvhShape(const Mesh& mesh, double margin) {
    MeshShape result{arraysOf(mesh.view()), nullptr};
    result.shape = std::make_unique<btBvhTriangleMeshShape>(result.arrays.get(), true);
    result.shape->setMargin(static_cast<btScalar>(margin));
    return result;
}

MeshShape hullShape(const Mesh& mesh, double margin) {
    btConvexHullComputer computer;
    computer.compute(mesh.vertices.front().data(), sizeof(Eigen::Vector3f), static_cast<int>(mesh.vertices.size()), 0,
                     0);
    auto shape = std::make_unique<btConvexHullShape>();
    for (int v = 0; v < computer.vertices.size(); ++v) {
        shape->addPoint(computer.vertices[v], false);
    }
    shape->recalcLocalAabb();
    shape->setMargin(static_cast<btScalar>(margin));
    return {nullptr, std::move(shape)};
}

}  // namespace grapeshot::scenes::detail
