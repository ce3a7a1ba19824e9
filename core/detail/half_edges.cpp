#include <grapeshot/core/detail/half_edges.hpp>

#include <algorithm>
#include <tuple>

namespace grapeshot::detail {

std::vector<HalfEdge> sortedHalfEdges(std::span<const Triangle> triangles, std::span<const std::uint32_t> welded,
                                      const std::vector<bool>& use) {
    std::vector<HalfEdge> edges;
    edges.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (!use.empty() && !use[t]) {
            continue;
        }
        for (std::uint8_t e = 0; e < 3; ++e) {
            const std::uint32_t from = welded[triangles[t][e]];
            const std::uint32_t to = welded[triangles[t][(e + 1U) % 3U]];
            if (from != to) {
                edges.push_back({std::min(from, to), std::max(from, to), t, e, from < to});
            }
        }
    }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle, a.edge) < std::tie(b.low, b.high, b.triangle, b.edge);
    });
    return edges;
}

std::size_t endOfEdge(const std::vector<HalfEdge>& edges, std::size_t begin) {
    std::size_t end = begin;
    while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) {
        ++end;
    }
    return end;
}

}  // namespace grapeshot::detail
