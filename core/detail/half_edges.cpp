#include <grapeshot/core/detail/half_edges.hpp>

#include <algorithm>
#include <tuple>

#include <grapeshot/core/detail/sliced_sort.hpp>

namespace grapeshot::detail {

Sliced sortHalfEdgesInSlices(std::span<const Triangle> triangles, std::span<const std::uint32_t> welded,
                             std::vector<HalfEdge>& edges) {
    edges.clear();
    edges.reserve(3 * triangles.size());
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
            for (std::uint8_t e = 0; e < 3; ++e) {
                const std::uint32_t from = welded[triangles[t][e]];
                const std::uint32_t to = welded[triangles[t][(e + 1U) % 3U]];
                if (from != to) {
                    edges.push_back({std::min(from, to), std::max(from, to), t, e, from < to});
                }
            }
        }
    };
    co_await inPieces(0, triangles.size(), 8, add);
    std::vector<HalfEdge> spare;
    co_await sortSliced(edges, 0, edges.size(), spare, [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle, a.edge) < std::tie(b.low, b.high, b.triangle, b.edge);
    });
}

std::size_t endOfEdge(const std::vector<HalfEdge>& edges, std::size_t begin) {
    std::size_t end = begin;
    while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) {
        ++end;
    }
    return end;
}

}  // namespace grapeshot::detail
