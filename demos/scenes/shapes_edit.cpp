// Putting meshes together, moving and scaling them.
#include <Eigen/Geometry>
#include <cassert>

#include <scenes/shapes.hpp>

namespace grapeshot::scenes {

Mesh moved(Mesh mesh, const Eigen::Vector3f& offset) {
    for (Eigen::Vector3f& v : mesh.vertices) {
        v += offset;
    }
    return mesh;
}

Mesh scaled(Mesh mesh, float factor) {
    assert(factor > 0);
    for (Eigen::Vector3f& v : mesh.vertices) {
        v *= factor;
    }
    return mesh;
}

Mesh merged(const Mesh& first, const Mesh& second, const Eigen::Vector3f& offset) {
    Mesh mesh = first;
    const auto shift = static_cast<std::uint32_t>(first.vertices.size());
    for (const Eigen::Vector3f& v : second.vertices) {
        mesh.vertices.push_back(v + offset);
    }
    for (const Triangle& t : second.triangles) {
        mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
    return mesh;
}

Mesh inwardCopy(const Mesh& mesh, float depth) {
    Mesh copy = mesh;
    std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Eigen::Vector3f& corner = mesh.vertices[t[0]];
        const Eigen::Vector3f normal = (mesh.vertices[t[1]] - corner).cross(mesh.vertices[t[2]] - corner);
        for (const std::uint32_t vertex : t) {
            normals[vertex] += normal;
        }
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        copy.vertices[i] -= depth * normals[i].normalized();
    }
    return copy;
}

Mesh normalised(Mesh mesh, float diagonal) {
    if (mesh.vertices.empty()) {
        return mesh;
    }
    Eigen::Vector3d lower = mesh.vertices.front().cast<double>();
    Eigen::Vector3d upper = lower;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        lower = lower.cwiseMin(v.cast<double>());
        upper = upper.cwiseMax(v.cast<double>());
    }
    const double size = (upper - lower).norm();
    const double factor = size > 0 ? diagonal / size : 1;
    const Eigen::Vector3d centre = 0.5 * (lower + upper);
    for (Eigen::Vector3f& v : mesh.vertices) {
        v = ((v.cast<double>() - centre) * factor).cast<float>();
    }
    return mesh;
}

}  // namespace grapeshot::scenes
