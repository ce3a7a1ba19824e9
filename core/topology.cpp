#include <grapeshot/core/topology.hpp>

#include <algorithm>

#include <grapeshot/core/mesh_slices.hpp>

#include <grapeshot/core/detail/half_edges.hpp>
#include <grapeshot/core/detail/welding.hpp>

namespace grapeshot {

Sliced buildTopologyInSlices(MeshView mesh, Topology& topology) {
    co_await detail::weldInSlices(mesh.vertices, topology.welded);
    topology.across.clear();
    topology.across.reserve(mesh.triangles.size());
    const auto clearAcross = [&](std::size_t, std::size_t end) {
        topology.across.resize(end, {noNeighbour, noNeighbour, noNeighbour});
    };
    co_await inPieces(0, mesh.triangles.size(), 256, clearAcross);
    topology.ringBegin.clear();
    topology.ringBegin.reserve(mesh.vertices.size() + 1);
    const auto clearRings = [&](std::size_t, std::size_t end) { topology.ringBegin.resize(end, 0); };
    co_await inPieces(0, mesh.vertices.size() + 1, 1024, clearRings);

    std::vector<detail::HalfEdge> edges;
    co_await detail::sortHalfEdgesInSlices(mesh.triangles, topology.welded, edges);
    topology.closed = !edges.empty();
    constexpr std::size_t perUnit = 64;
    for (std::size_t begin = 0; begin < edges.size();) {
        co_yield mostSlicedPiece;
        for (const std::size_t pause = begin + mostSlicedPiece * perUnit; begin < std::min(pause, edges.size());) {
            const std::size_t end = detail::endOfEdge(edges, begin);
            const detail::HalfEdge& first = edges[begin];
            ++topology.ringBegin[first.low + 1];
            ++topology.ringBegin[first.high + 1];
            if (detail::isOrientedPair(edges, begin, end) && first.triangle != edges[begin + 1].triangle) {
                const detail::HalfEdge& second = edges[begin + 1];
                topology.across[first.triangle][first.edge] = second.triangle;
                topology.across[second.triangle][second.edge] = first.triangle;
            } else {
                topology.closed = false;
            }
            begin = end;
        }
    }
    const auto addUp = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            topology.ringBegin[v + 1] += topology.ringBegin[v];
        }
    };
    co_await inPieces(0, mesh.vertices.size(), 256, addUp);
    topology.ring.clear();
    topology.ring.reserve(topology.ringBegin.back());
    const auto clearRing = [&](std::size_t, std::size_t end) { topology.ring.resize(end); };
    co_await inPieces(0, topology.ringBegin.back(), 1024, clearRing);
    std::vector<std::uint32_t> next;
    next.reserve(mesh.vertices.size());
    const auto copyNext = [&](std::size_t begin, std::size_t end) {
        next.insert(next.end(), topology.ringBegin.begin() + static_cast<std::ptrdiff_t>(begin),
                    topology.ringBegin.begin() + static_cast<std::ptrdiff_t>(end));
    };
    co_await inPieces(0, mesh.vertices.size(), 1024, copyNext);
    // Sorted by (low, high): for a vertex v all edges (u, v) with u < v come before all (v, w), so each ring is filled
    // in ascending order.
    for (std::size_t begin = 0; begin < edges.size();) {
        co_yield mostSlicedPiece;
        for (const std::size_t pause = begin + mostSlicedPiece * perUnit; begin < std::min(pause, edges.size());) {
            topology.ring[next[edges[begin].high]++] = edges[begin].low;
            topology.ring[next[edges[begin].low]++] = edges[begin].high;
            begin = detail::endOfEdge(edges, begin);
        }
    }
}

Topology buildTopology(MeshView mesh) {
    Topology topology;
    buildTopologyInSlices(mesh, topology).run();
    return topology;
}

}  // namespace grapeshot
