#include "triangle_arrays.hpp"

namespace grapeshot::scenes {

std::unique_ptr<btTriangleIndexVertexArray> arraysOf(MeshView mesh) {
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

}  // namespace grapeshot::scenes
