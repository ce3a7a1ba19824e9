// The judge of soft scenes: which edges pass through which triangles, by arithmetic of its own in double precision. It
// shares no code with the library and knows nothing of its contacts: nodes on the wrong side leave crossed edges.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::soft {

/// World frame, m.
struct Surface {
    std::vector<Eigen::Vector3d> points;
    std::vector<Triangle> triangles;
};

/// An edge's ends, and the triangle that it passes through.
struct CrossedEdge {
    std::uint32_t from, to, triangle;
};
/// Möller and Trumbore, open on all borders: what only touches does not pass.
[[nodiscard]] bool passesThrough(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// All pairs of an edge of `edges` and a triangle of `faces` that meet, in both surfaces' interior. With the same
/// surface twice, pairs that share a vertex are left out. Surfaces that only touch have none. Some us a triangle;
/// triangles with points that are no numbers, farther than 1 km or larger than 4 m are passed over.
[[nodiscard]] std::vector<CrossedEdge> crossedEdges(const Surface& edges, const Surface& faces);
[[nodiscard]] std::size_t crossings(const Surface& edges, const Surface& faces);

/// Edges of one through triangles of the other, both ways.
[[nodiscard]] std::size_t crossingsOfBoth(const Surface& a, const Surface& b);

}  // namespace grapeshot::soft
