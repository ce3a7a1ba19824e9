// What is built once on a mesh: its features on several levels, and an incomplete hierarchy.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004 (levels)
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::scf::reference {

/// Lists of lists.
struct Lists {
    std::vector<std::uint32_t> begin{0};  ///< per list, and the end
    std::vector<std::uint32_t> items;
    [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t list) const {
        return {items.data() + begin[list], begin[list + 1] - begin[list]};
    }
};

/// Features of one level: balls about mesh vertices. Level 0 has every vertex that a triangle uses; a feature of a
/// coarser level stands for a handful of neighbouring ones of the level below.
struct Level {
    std::vector<std::uint32_t> centre;  ///< vertex of the mesh
    std::vector<std::uint32_t> parent;  ///< feature of the next coarser level; empty at the coarsest
    Lists children;                     ///< features of the next finer level; empty at level 0
    Lists ring;                         ///< neighbours on this level, ascending, without itself
};

/// A binary tree of boxes that ends before its leaves are small.
struct ShallowNode {
    std::uint32_t first = 0;  ///< inner: left child, the right one follows it; leaf: first of its triangles
    std::uint32_t count = 0;  ///< leaf: triangles, in `order`; inner: 0
    int depth = 0;            ///< of the root: 0
    [[nodiscard]] bool isLeaf() const { return count > 0; }
};
struct ShallowTree {
    std::vector<ShallowNode> nodes;    ///< parents before children
    std::vector<std::uint32_t> order;  ///< triangles, those of a leaf together
};

struct SurfaceSettings {
    int treeDepth = 8;  ///< 0 to 16
    int coarsest = 40;  ///< >= 1: levels are added while the last one has more features and still shrinks
};

/// Plain data; does not change while the mesh deforms.
struct Surface {
    std::vector<Triangle> triangles;       ///< by welded vertices
    std::size_t vertexCount = 0;           ///< of the mesh, as it came
    std::vector<std::uint32_t> featureOf;  ///< level-0 feature per welded vertex, or noNeighbour
    std::vector<Level> levels;
    Lists fan;  ///< triangles around each feature of level 0
    ShallowTree tree;
};

/// @throws Error as requireUsable(MeshView) does; badSetting
[[nodiscard]] Surface buildSurface(MeshView rest, const SurfaceSettings& settings = {});

}  // namespace grapeshot::scf::reference
