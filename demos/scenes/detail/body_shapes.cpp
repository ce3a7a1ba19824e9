#include "body_shapes.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btConvexHullComputer.h>

namespace grapeshot::scenes::detail {

namespace {

std::unique_ptr<btTriangleIndexVertexArray> arraysOf(const Mesh& mesh) {
    btIndexedMesh part;
    part.m_numTriangles = static_cast<int>(mesh.triangles.size());
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(mesh.triangles.data());
    part.m_triangleIndexStride = sizeof(Triangle);
    part.m_numVertices = static_cast<int>(mesh.vertices.size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertices.data());
    part.m_vertexStride = sizeof(Eigen::Vector3f);
    part.m_vertexType = PHY_FLOAT;  // also where btScalar is double
    auto arrays = std::make_unique<btTriangleIndexVertexArray>();
    arrays->addIndexedMesh(part, PHY_INTEGER);
    return arrays;
}

}  // namespace

MeshShape gimpactShape(const Mesh& mesh, double margin) {
    MeshShape result{arraysOf(mesh), nullptr};
    auto shape = std::make_unique<btGImpactMeshShape>(result.arrays.get());
    shape->setMargin(static_cast<btScalar>(margin));
    shape->updateBound();
    result.shape = std::move(shape);
    return result;
}

MeshShape bvhShape(const Mesh& mesh, double margin) {
    MeshShape result{arraysOf(mesh), nullptr};
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
