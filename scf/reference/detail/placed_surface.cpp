#include <grapeshot/scf/reference/detail/placed_surface.hpp>

#include <algorithm>
#include <string>

#include <grapeshot/core/error.hpp>

namespace grapeshot::scf::reference::detail {

PlacedSurface::PlacedSurface(const Surface& surface, std::span<const Eigen::Vector3f> vertices, const char* place)
    : m_surface(&surface), m_vertices(vertices) {
    if (vertices.size() != surface.vertexCount) {
        throw Error(Fault::topologyChanged,
                    std::to_string(vertices.size()) + " vertices, built on " + std::to_string(surface.vertexCount),
                    place);
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (!vertices[v].allFinite()) {
            throw Error(Fault::notFinite, "a NaN or an infinity", std::string(place) + ", vertex " + std::to_string(v));
        }
    }
    m_radii.resize(surface.levels.size());
    for (std::size_t l = 0; l < surface.levels.size(); ++l) {
        const Level& here = surface.levels[l];
        m_radii[l].assign(here.centre.size(), 0);
        for (std::uint32_t f = 0; f < here.centre.size(); ++f) {
            float& radius = m_radii[l][f];
            if (l == 0) {
                for (const std::uint32_t neighbour : here.ring[f]) {
                    radius = std::max(radius, (at(0, neighbour) - at(0, f)).norm());
                }
            } else {
                for (const std::uint32_t child : here.children[f]) {
                    radius = std::max(radius, (at(l - 1, child) - at(l, f)).norm() + m_radii[l - 1][child]);
                }
            }
        }
    }
    m_boxes = fitted(surface.tree, surface.triangles, vertices);
}

std::array<Eigen::Vector3f, 3> PlacedSurface::corners(std::uint32_t triangle) const {
    const Triangle& t = m_surface->triangles[triangle];
    return {m_vertices[t[0]], m_vertices[t[1]], m_vertices[t[2]]};
}

}  // namespace grapeshot::scf::reference::detail
