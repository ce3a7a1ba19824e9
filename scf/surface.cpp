#include <grapeshot/scf/surface.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/core/mesh_slices.hpp>
#include <grapeshot/scf/ball_tree_builder.hpp>
#include <grapeshot/scf/detail/sliced_vectors.hpp>

namespace grapeshot {

using detail::copyInSlices;
using detail::fillInSlices;

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

Sliced makeFans(MeshView mesh, IndexLists& fan) {
    co_await fillInSlices(fan.begin, mesh.vertices.size() + 1, 0U);
    const auto count = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            forEachCorner(mesh.triangles[t], [&](std::uint32_t v) { ++fan.begin[v + 1]; });
        }
    };
    co_await inPieces(0, mesh.triangles.size(), 32, count);
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            fan.begin[v + 1] += fan.begin[v];
        }
    };
    co_await inPieces(0, mesh.vertices.size(), 128, add);
    co_await fillInSlices(fan.all, fan.begin.back(), 0U);
    std::vector<std::uint32_t> next;
    co_await copyInSlices(std::span<const std::uint32_t>(fan.begin), next);
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            forEachCorner(mesh.triangles[t],
                          [&](std::uint32_t v) { fan.all[next[v]++] = static_cast<std::uint32_t>(t); });
        }
    };
    co_await inPieces(0, mesh.triangles.size(), 16, list);
}

Sliced makeRings(MeshView mesh, const IndexLists& fan, IndexLists& ring) {
    ring.begin.reserve(mesh.vertices.size() + 1);
    ring.begin.push_back(0);
    ring.all.reserve(6 * mesh.vertices.size());
    std::vector<std::uint32_t> around;
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
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
    };
    co_await inPieces(0, mesh.vertices.size(), 2, list);
}

Sliced listEdges(Surface& surface) {
    const std::size_t edges = surface.ring.all.size() / 2;
    surface.edges.begin.reserve(surface.rest.size() + 1);
    surface.edges.begin.push_back(0);
    surface.edges.all.reserve(edges);
    surface.edgeSquare.reserve(edges);
    float longest = 0;
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
            for (const std::uint32_t other : surface.ring.of(v)) {
                if (other > v) {
                    surface.edges.all.push_back(other);
                    surface.edgeSquare.push_back((surface.rest[other] - surface.rest[v]).squaredNorm());
                    longest = std::max(longest, surface.edgeSquare.back());
                }
            }
            surface.edges.begin.push_back(static_cast<std::uint32_t>(surface.edges.all.size()));
        }
    };
    co_await inPieces(0, surface.rest.size(), 6, list);
    if (!surface.edgeSquare.empty()) {
        surface.longestEdge = 1.00001F * std::sqrt(longest);
    }
}

}  // namespace

Sliced makeSurfaceInSlices(MeshView rest, Surface& surface) {
    co_await requireUsableInSlices(rest);
    co_await copyInSlices(rest.vertices, surface.rest);
    co_await copyInSlices(rest.triangles, surface.triangles);
    co_await makeFans(rest, surface.fan);
    co_await makeRings(rest, surface.fan, surface.ring);
    co_await listEdges(surface);
    co_await contentKeyInSlices({{}, surface.triangles}, surface.topology);
}

Surface makeSurface(MeshView rest) {
    Surface surface;
    makeSurfaceInSlices(rest, surface).run();
    return surface;
}

ContentKey topologyKey(std::span<const Triangle> triangles) noexcept {
    return contentKey({{}, triangles});
}

}  // namespace grapeshot
