// Who is whose neighbour on a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot {

inline constexpr std::uint32_t noNeighbour = 0xffffffffU;

/// Adjacency of a mesh after welding vertices of exactly equal position. Plain data, built once; does not change while
/// the mesh deforms.
struct Topology {
    /// Representative of each vertex among those at its position: the lowest index.
    std::vector<std::uint32_t> welded;
    /// Per triangle and edge e (corner e to corner e+1): the triangle across, or noNeighbour on a boundary,
    /// non-manifold or misoriented edge.
    std::vector<std::array<std::uint32_t, 3>> across;
    /// Ring of a welded vertex: welded vertices that share an edge with it, ascending, in
    /// ring[ringBegin[v] .. ringBegin[v + 1]). Empty for vertices that are not representatives.
    std::vector<std::uint32_t> ringBegin;
    std::vector<std::uint32_t> ring;
    bool closed = false;  ///< every edge has exactly one neighbour, in opposite direction

    [[nodiscard]] std::span<const std::uint32_t> ringOf(std::uint32_t weldedVertex) const {
        return {ring.data() + ringBegin[weldedVertex], ringBegin[weldedVertex + 1] - ringBegin[weldedVertex]};
    }
};

/// O(n log n). The mesh must be usable (see requireUsable).
[[nodiscard]] Topology buildTopology(MeshView mesh);

}  // namespace grapeshot
