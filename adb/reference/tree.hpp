// A binary hierarchy over one mesh, and the one number per node that makes an ADB-tree of it.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
// Gabriel Zachmann. Minimal Hierarchical Collision Detection. VRST 2002 (splits by the sum of the volumes)
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/adb/reference/box.hpp>
#include <grapeshot/adb/reference/intersection_volume.hpp>
#include <grapeshot/adb/reference/placement.hpp>
#include <grapeshot/adb/reference/settings.hpp>
#include <grapeshot/core/mesh_view.hpp>

namespace grapeshot::reference {

/// What the method asks of a bounding volume: enclose points, say which box its grid stands in, and tell whether two of
/// them are disjoint at a given placement.
template <class V>
concept BoundingVolume = requires(V volume, std::span<const Eigen::Vector3d> points, const Placement& placement) {
    { V::around(points) } -> std::same_as<V>;
    volume.inflate(1.0);
    { volume.box() } -> std::convertible_to<Box>;
    { typename V::PairTest(placement).disjoint(volume, volume) } -> std::same_as<bool>;
};

/// The shape of the tree, the same for every kind of volume.
struct TreeNode {
    std::uint32_t left = 0;   ///< the right child stands behind it; 0 for a leaf
    std::uint32_t begin = 0;  ///< range of Hierarchy::triangles
    std::uint32_t end = 0;
    int depth = 0;             ///< 0 for the root
    double coneHalfAngle = 0;  ///< of the normals below, about their mean; pi where that cancels
    [[nodiscard]] bool isLeaf() const { return left == 0; }
};

struct Hierarchy {
    std::vector<TreeNode> nodes;                            ///< children stand after their parents
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;  ///< corners, in the order of the leaves
    std::vector<std::uint32_t> triangleIds;                 ///< their index in the mesh
    int maxDepth = 0;
    double radius = 0;  ///< of the mesh about its frame's origin, m
};

/// Splits at a place in the sorted middle half of an axis where the sum of both boxes' volumes is least.
/// @param mostPerLeaf triangles, >= 1; the paper's trees have one
/// @throws Error emptyMesh, noSurface, indexOutOfRange, notFinite, tooLarge, badSetting
[[nodiscard]] Hierarchy buildHierarchy(MeshView mesh, int mostPerLeaf = 1);

/// Corners of all triangles of a range, for enclosing them.
[[nodiscard]] std::span<const Eigen::Vector3d> cornersOf(const Hierarchy& hierarchy, const TreeNode& node);

/// A hierarchy of one kind of volume. A value; holds no counts, which depend on FillSettings.
template <BoundingVolume V>
struct BoundedTree {
    Hierarchy hierarchy;
    std::vector<V> volumes;       ///< per node
    std::vector<Extent> extents;  ///< per node, of its thickened box
    std::vector<Eigen::Vector3d> centers;
};

template <BoundingVolume V>
[[nodiscard]] BoundedTree<V> bounded(const Hierarchy& hierarchy) {
    BoundedTree<V> tree{.hierarchy = hierarchy, .volumes = {}, .extents = {}, .centers = {}};
    // All rounding of the pair tests, for bodies up to a thousand of their radii apart.
    const double slack = 1e-12 * tree.hierarchy.radius;
    for (const TreeNode& node : tree.hierarchy.nodes) {
        V volume = V::around(cornersOf(tree.hierarchy, node));
        volume.inflate(slack);
        const Box box = thickened(volume.box());
        tree.extents.push_back(extentOf(box));
        tree.centers.push_back(box.center());
        tree.volumes.push_back(volume);
    }
    return tree;
}

/// Per node, how many cells of the grid in its box are well filled by P(A): all triangles that touch the box, not only
/// those below the node.
struct CellCounts {
    FillSettings settings;
    std::vector<int> wellFilled;
};

/// For several tau at the price of one: the clipping is what costs.
/// @param boxes per node of the hierarchy
/// @throws Error badSetting
[[nodiscard]] std::vector<CellCounts> countCells(const Hierarchy& hierarchy, std::span<const Box> boxes, int grid,
                                                 std::span<const double> taus);

template <BoundingVolume V>
[[nodiscard]] std::vector<CellCounts> countCells(const BoundedTree<V>& tree, int grid, std::span<const double> taus) {
    std::vector<Box> boxes;
    for (const V& volume : tree.volumes) {
        boxes.push_back(thickened(volume.box()));
    }
    return countCells(tree.hierarchy, boxes, grid, taus);
}

template <BoundingVolume V>
[[nodiscard]] CellCounts countCells(const BoundedTree<V>& tree, const FillSettings& settings = {}) {
    return countCells(tree, settings.grid, std::array{settings.tau}).front();
}

}  // namespace grapeshot::reference
