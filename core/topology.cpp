#include <grapeshot/core/topology.hpp>

#include <grapeshot/core/detail/half_edges.hpp>
#include <grapeshot/core/detail/welding.hpp>

namespace grapeshot {

Topology buildTopology(MeshView mesh) {
    Topology topology;
    topology.welded = detail::weld(mesh.vertices);
    topology.across.assign(mesh.triangles.size(), {noNeighbour, noNeighbour, noNeighbour});
    const std::vector<detail::HalfEdge> edges = detail::sortedHalfEdges(mesh.triangles, topology.welded);
    topology.closed = !edges.empty();
    topology.ringBegin.assign(mesh.vertices.size() + 1, 0);
    for (std::size_t begin = 0; begin < edges.size();) {
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
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        topology.ringBegin[v + 1] += topology.ringBegin[v];
    }
    topology.ring.resize(topology.ringBegin.back());
    std::vector<std::uint32_t> next(topology.ringBegin.begin(), topology.ringBegin.end() - 1);
    // Sorted by (low, high): for a vertex v all edges (u, v) with u < v come before all (v, w), so each ring is filled
    // in ascending order.
    for (std::size_t begin = 0; begin < edges.size(); begin = detail::endOfEdge(edges, begin)) {
        topology.ring[next[edges[begin].high]++] = edges[begin].low;
        topology.ring[next[edges[begin].low]++] = edges[begin].high;
    }
    return topology;
}

}  // namespace grapeshot
