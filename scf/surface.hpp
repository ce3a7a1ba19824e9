// A triangle mesh at rest, and who is whose neighbour on it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot {

/// Lists of indices, one after the other: that of i is all[begin[i] .. begin[i + 1]).
struct IndexLists {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint32_t> all;

    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t i) const {
        return {all.data() + begin[i], begin[i + 1] - begin[i]};
    }
};

/// A value that owns copies of what it was made of. Neighbours are so by index: vertices at the same place are not
/// welded, because nothing says that they stay together when the mesh deforms. Open, non-manifold, degenerate and
/// disconnected meshes are as good as others: nothing here asks how many triangles an edge has.
struct Surface {
    std::vector<Eigen::Vector3f> rest;  ///< vertices at rest, m
    std::vector<Triangle> triangles;
    IndexLists ring;                ///< vertices that share an edge with a vertex, ascending, without itself
    IndexLists fan;                 ///< triangles around a vertex, ascending; one with a repeated corner stands once
    IndexLists edges;               ///< every edge once, at its lower vertex: the higher one
    std::vector<float> edgeSquare;  ///< per entry of `edges`: squared length at rest, m^2
    float longestEdge = 0;          ///< at rest, m
    ContentKey topology;            ///< of the triangles alone, as `topologyKey` has it

    [[nodiscard]] MeshView mesh() const { return {rest, triangles}; }
};

/// O(n), about 0.2 us a triangle.
/// @throws Error as requireUsable does
[[nodiscard]] Surface makeSurface(MeshView rest);

/// What the triangles are, whatever the positions: for noticing that they were changed. Several gigabytes a second.
[[nodiscard]] ContentKey topologyKey(std::span<const Triangle> triangles) noexcept;

}  // namespace grapeshot
