// The edges of a welded mesh, sorted so that those between the same two vertices stand together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/sliced.hpp>

namespace grapeshot::detail {

/// One side of a triangle, between welded vertices low < high.
struct HalfEdge {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    std::uint32_t triangle = 0;
    std::uint8_t edge = 0;   ///< corner `edge` to the next
    bool ascending = false;  ///< the triangle runs from low to high
};

/// Half edges of the triangles, sorted by (low, high, triangle, edge). Sides whose ends are welded together are left
/// out. Indices must be in range.
Sliced sortHalfEdgesInSlices(std::span<const Triangle> triangles, std::span<const std::uint32_t> welded,
                             std::vector<HalfEdge>& edges);

/// End of the run of half edges that share both vertices with `begin`.
[[nodiscard]] std::size_t endOfEdge(const std::vector<HalfEdge>& edges, std::size_t begin);

/// The two half edges from `begin` on are one edge of a consistently oriented surface.
[[nodiscard]] inline bool isOrientedPair(const std::vector<HalfEdge>& edges, std::size_t begin, std::size_t end) {
    return end - begin == 2 && edges[begin].ascending != edges[begin + 1].ascending;
}

}  // namespace grapeshot::detail
