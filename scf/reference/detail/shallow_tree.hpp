// The incomplete hierarchy: built once, its boxes fitted to each step's vertices.
//
// This work is based on:
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include <grapeshot/scf/reference/surface.hpp>

namespace grapeshot::scf::reference::detail {

struct Bounds {
    Eigen::Vector3f lower, upper;
    [[nodiscard]] bool contains(const Eigen::Vector3f& p) const {
        return (lower.array() <= p.array()).all() && (p.array() <= upper.array()).all();
    }
};

/// Halves of equal count along the longest side, down to `depth`.
[[nodiscard]] ShallowTree buildShallowTree(std::span<const Eigen::Vector3f> vertices,
                                           std::span<const Triangle> triangles, int depth);

/// A box per node. O(triangles).
[[nodiscard]] std::vector<Bounds> fitted(const ShallowTree& tree, std::span<const Triangle> triangles,
                                         std::span<const Eigen::Vector3f> vertices);

using NodePair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of nodes at `depth` (or leaves above it) whose boxes come within `reach`, m; adds the boxes tested to `tests`.
[[nodiscard]] std::vector<NodePair> overlappingNodes(const ShallowTree& a, std::span<const Bounds> boxesA,
                                                     const ShallowTree& b, std::span<const Bounds> boxesB, int depth,
                                                     float reach, std::size_t& tests);

/// The triangles below a node, at any depth.
[[nodiscard]] std::span<const std::uint32_t> trianglesBelow(const ShallowTree& tree, std::uint32_t node);

}  // namespace grapeshot::scf::reference::detail
