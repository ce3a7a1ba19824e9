#include <grapeshot/scf/surface.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot {
namespace {

/// Runs over the distinct corners of a triangle.
template <class Run>
void forEachCorner(const Triangle& t, const Run& run) {
    run(t[0]);
    if (t[1] != t[0]) {
        run(t[1]);
    }
    if (t[2] != t[0] && t[2] != t[1]) {
        run(t[2]);
    }
}

IndexLists fansOf(MeshView mesh) {
    IndexLists fan;
    fan.begin.assign(mesh.vertices.size() + 1, 0);
    for (const Triangle& triangle : mesh.triangles) {
        forEachCorner(triangle, [&](std::uint32_t v) { ++fan.begin[v + 1]; });
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        fan.begin[v + 1] += fan.begin[v];
    }
    fan.all.resize(fan.begin.back());
    std::vector<std::uint32_t> next(fan.begin.begin(), fan.begin.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        forEachCorner(mesh.triangles[t], [&](std::uint32_t v) { fan.all[next[v]++] = t; });
    }
    return fan;
}

IndexLists ringsOf(MeshView mesh, const IndexLists& fan) {
    IndexLists ring;
    ring.begin.reserve(mesh.vertices.size() + 1);
    ring.begin.push_back(0);
    std::vector<std::uint32_t> around;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        around.clear();
        for (const std::uint32_t t : fan.of(v)) {
            forEachCorner(mesh.triangles[t], [&](std::uint32_t other) {
                if (other != v) {
                    around.push_back(other);
                }
            });
        }
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        ring.all.insert(ring.all.end(), around.begin(), around.end());
        ring.begin.push_back(static_cast<std::uint32_t>(ring.all.size()));
    }
    return ring;
}

void listEdges(Surface& surface) {
    const std::size_t edges = surface.ring.all.size() / 2;
    surface.edges.begin.reserve(surface.rest.size() + 1);
    surface.edges.begin.push_back(0);
    surface.edges.all.reserve(edges);
    surface.edgeSquare.reserve(edges);
    for (std::uint32_t v = 0; v < surface.rest.size(); ++v) {
        for (const std::uint32_t other : surface.ring.of(v)) {
            if (other > v) {
                surface.edges.all.push_back(other);
                surface.edgeSquare.push_back((surface.rest[other] - surface.rest[v]).squaredNorm());
            }
        }
        surface.edges.begin.push_back(static_cast<std::uint32_t>(surface.edges.all.size()));
    }
    if (!surface.edgeSquare.empty()) {
        surface.longestEdge =
            1.00001F * std::sqrt(*std::max_element(surface.edgeSquare.begin(), surface.edgeSquare.end()));
    }
}

}  // namespace

Surface makeSurface(MeshView rest) {
    requireUsable(rest);
    Surface surface;
    surface.rest.assign(rest.vertices.begin(), rest.vertices.end());
    surface.triangles.assign(rest.triangles.begin(), rest.triangles.end());
    surface.fan = fansOf(rest);
    surface.ring = ringsOf(rest, surface.fan);
    listEdges(surface);
    surface.topology = topologyKey(surface.triangles);
    return surface;
}

ContentKey topologyKey(std::span<const Triangle> triangles) noexcept {
    return contentKey({{}, triangles});
}

}  // namespace grapeshot
