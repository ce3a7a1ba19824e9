#include <grapeshot/narrowphase/detail/extremum.hpp>

#include <cmath>

#include <Eigen/Geometry>

namespace grapeshot::detail {

using Eigen::Vector3f;

bool cornerIsExtremal(const MeshModel& model, std::uint32_t vertex, const Vector3f& towards, float lean) {
    const Vector3f& here = model.tree.vertices[vertex];
    for (const std::uint32_t neighbour : model.topology.ringOf(vertex)) {
        const Vector3f along = model.tree.vertices[neighbour] - here;
        const float leads = along.dot(towards);
        if (leads > 0 && leads * leads > lean * lean * along.squaredNorm()) {
            return false;
        }
    }
    return true;
}

bool edgeIsExtremal(const MeshModel& model, std::uint32_t triangle, unsigned edge, const Vector3f& towards,
                    float lean) {
    const Triangle& corner = model.tree.triangles[triangle];
    const Vector3f along = model.tree.vertices[corner[(edge + 1) % 3]] - model.tree.vertices[corner[edge]];
    // The direction into the triangle is normal x along, so its share along `towards` is normal . (along x towards).
    const Vector3f side = along.cross(towards);
    const float limit = lean * along.norm();
    if (model.triangleNormals[triangle].dot(side) > limit) {
        return false;
    }
    const std::uint32_t other = model.topology.across[triangle][edge];
    return other == noNeighbour || -model.triangleNormals[other].dot(side) <= limit;
}

bool faceIsExtremal(const MeshModel& model, std::uint32_t triangle, const Vector3f& towards, float lean) {
    const float cosine = model.triangleNormals[triangle].dot(towards);
    const float least = std::sqrt(std::max(0.0F, 1 - lean * lean));
    return model.solid ? cosine >= least : std::abs(cosine) >= least;
}

Vector3f pseudonormal(const MeshModel& model, std::uint32_t triangle, int feature) {
    if (feature < 3) {
        return model.vertexNormals[model.tree.triangles[triangle][static_cast<unsigned>(feature)]];
    }
    Vector3f normal = model.triangleNormals[triangle];
    if (feature < 6) {
        const std::uint32_t other = model.topology.across[triangle][static_cast<unsigned>(feature - 3)];
        if (other != noNeighbour) {
            normal += model.triangleNormals[other];
        }
    }
    return normal;
}

bool isInside(const MeshModel& solid, const Vector3f& point, float reach) {
    const auto closest = closestPoint(solid.tree, point, reach);
    return closest && (point - closest->point).dot(pseudonormal(solid, closest->triangle, closest->feature)) < 0;
}

}  // namespace grapeshot::detail
