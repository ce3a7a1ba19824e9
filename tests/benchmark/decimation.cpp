#include "decimation.hpp"

#include <meshoptimizer.h>

#include <limits>
#include <vector>

namespace grapeshot::bench {

scenes::Mesh decimated(MeshView mesh, std::size_t triangles) {
    static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
    constexpr float anyError = 1e6F;
    std::vector<Triangle> left(mesh.triangles.size());
    const std::size_t indices = meshopt_simplify(
        left.data()->data(), mesh.triangles.data()->data(), 3 * mesh.triangles.size(), mesh.vertices.data()->data(),
        mesh.vertices.size(), sizeof(Eigen::Vector3f), 3 * triangles, anyError);
    left.resize(indices / 3);

    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> places(mesh.vertices.size(), unused);
    scenes::Mesh result;
    for (Triangle& triangle : left) {
        for (std::uint32_t& corner : triangle) {
            if (places[corner] == unused) {
                places[corner] = static_cast<std::uint32_t>(result.vertices.size());
                result.vertices.push_back(mesh.vertices[corner]);
            }
            corner = places[corner];
        }
    }
    result.triangles = std::move(left);
    return result;
}

}  // namespace grapeshot::bench
