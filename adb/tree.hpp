// The hierarchy over one mesh: 4-wide nodes that bound their triangles by a box and a slab, and know how the surface
// below them is distributed.
//
// This work is based on:
// Ingo Wald. On fast Construction of SAH-based Bounding Volume Hierarchies. 2007 (binned building)
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>
#include <grapeshot/core/triangle_pair.hpp>

namespace grapeshot {

/// What a slot of a node holds. Inner: index of a node. Leaf: index of a leaf block, with the top bit set.
using ChildRef = std::uint32_t;
inline constexpr ChildRef noChild = 0xffffffffU;
inline constexpr ChildRef leafBit = 0x80000000U;

[[nodiscard]] constexpr bool isLeaf(ChildRef ref) noexcept {
    return (ref & leafBit) != 0U;
}
[[nodiscard]] constexpr std::uint32_t indexOf(ChildRef ref) noexcept {
    return ref & ~leafBit;
}

/// Four children side by side; everything in the mesh's frame. An empty slot has child noChild and a box that no test
/// hits (negative half extents). Three cache lines.
struct alignas(64) Node {
    float center[3][4];  ///< middle of each child's box, m
    float half[3][4];    ///< half extents, m, rounded up so that the box holds its triangles
    float normal[3][4];  ///< unit mean normal of the child's surface, or an arbitrary unit vector where it cancels
    float slabLow[4];    ///< the child's triangles x satisfy slabLow <= normal . (x - center) <= slabHigh, m
    float slabHigh[4];   ///< (rounded outwards; about the box's middle, which keeps precision far from the origin)
    ChildRef child[4];
};
static_assert(sizeof(Node) == 192);

/// How the surface below each child is distributed, in 8 bits a number: one cache line. Beside the node because the
/// exact traversal does without it. [entry][slot]. See ChildSurface for the numbers.
struct alignas(64) NodeDistribution {
    float size[4];             ///< m, positive: unit of mean and root, times 127
    std::int8_t mean[3][4];    ///< centroid from the middle of the child's box
    std::int8_t root[6][4];    ///< 00, 10, 11, 20, 21, 22: the covariance is this (Cholesky, lower) times its transpose
    std::uint8_t flatness[4];  ///< in 1 / 255
    std::int16_t area[4];      ///< log2 of the area in m^2, in 1 / 256; below -100: no area
};
static_assert(sizeof(NodeDistribution) == 64);

/// How the surface below a child is distributed, as exactly as the tree has it.
struct ChildSurface {
    double area;                 ///< m^2; within 0.2 %
    Eigen::Vector3d mean;        ///< m, area-weighted centroid; within 1/254 of the child's largest half extent
    Eigen::Matrix3d covariance;  ///< m^2, about the mean; with 0.005 of its trace added to the diagonal, so that a flat
                                 ///< piece has a thickness of 7 % of its size
    double flatness;             ///< |integral of the normal| / area: 1 is a plane, 0 a closed surface
};
[[nodiscard]] ChildSurface surfaceOf(const Node& node, const NodeDistribution& distribution, int slot) noexcept;

/// How a whole mesh's surface is distributed, ready for four lanes at a time.
struct alignas(16) WholeSurface {
    float mean[4] = {};           ///< area-weighted centroid, m; the last is 0
    float covariance[3][4] = {};  ///< columns, about the mean, in unit^2; thickened as in ChildSurface; the last are 0
    float unit = 1;               ///< m, a power of two: about half the diagonal of the mesh's box
};

/// Up to four triangles as structure of arrays. Unused lanes repeat lane 0 and have triangle id noTriangle.
struct alignas(16) LeafBlock {
    float corner[3][3][4];  ///< [corner][axis][lane]
    std::uint32_t triangle[4];
};

struct BuildSettings {
    int maxLeafTriangles = 4;  ///< 1..4
    int bins = 16;             ///< 4..64; more: slower build, slightly better tree
    int tuningPoses = 1024;    ///< 0..10000: of `tune` (tuning.hpp); 0 leaves it out, for who never estimates
};

/// A value: copy it, move it, share it between threads for reading. Owns copies of vertices and triangles, so the mesh
/// it was built on may go. `nodes[0]` is the root.
struct Tree {
    std::vector<Node> nodes;  ///< children stand after their parents
    std::vector<NodeDistribution> distributions;
    std::vector<LeafBlock> leaves;
    std::vector<Eigen::Vector3f> vertices;
    std::vector<Triangle> triangles;
    Eigen::Vector3f lower = Eigen::Vector3f::Zero();  ///< box of the mesh
    Eigen::Vector3f upper = Eigen::Vector3f::Zero();
    WholeSurface whole;
    float radius = 0;  ///< of the mesh about its frame's origin, m: bounds how far a rotation moves a point
    /// What the sum of the rates of the mesh against itself is multiplied with, after one step, two, three and four,
    /// and more (see tuning.hpp); 1/16..16.
    std::array<float, 4> stepRates{1, 1, 1, 1};

    [[nodiscard]] MeshView mesh() const { return {vertices, triangles}; }
};

/// Binned SAH, top down, deterministic; then tuned. O(n log n), about 1 us a triangle, and 1 us
/// a pose of the tuning.
/// @throws Error as requireUsable does, and badSetting.
[[nodiscard]] Tree build(MeshView mesh, const BuildSettings& settings = {});

/// New vertex positions, same triangles: boxes, slabs and moments are made anew bottom-up; the shape of the tree stays,
/// and so does what it was tuned to. On error the tree is unchanged. O(n) for boxes and moments, O(n log n) for the
/// slabs; about a quarter of a build.
/// @throws Error topologyChanged (another number of vertices), notFinite, tooLarge
void refit(Tree& tree, std::span<const Eigen::Vector3f> vertices);

/// What is malformed in a tree, in words, a line each; empty if nothing is. For tests and debugging: every triangle in
/// exactly one leaf, boxes and slabs hold what is below them, moments add up.
[[nodiscard]] std::vector<std::string> findings(const Tree& tree);

}  // namespace grapeshot
