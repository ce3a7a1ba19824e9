// Nested pieces of a surface, each in a ball around one of its vertices: valid for every deformation that stretches no
// edge by more than a bound, without a refit.
//
// A path along edges from the centre to a vertex is at most `bound` times as long as at rest, so the vertex stays
// within `bound` times its distance along edges at rest. Triangles lie in the hull of their corners. So a traversal
// reads the positions of the centres that it visits, and nothing else.
//
// This work is based on:
// Sean Quinlan. Efficient Distance Computation between Non-Convex Objects. ICRA 1994 (trees of spheres on the surface)
// Thomas Larsson, Tomas Akenine-Moeller. A Dynamic Bounding Volume Hierarchy for Generalized Collision Detection.
// Computers & Graphics 30, 2006 (bounds made only where a traversal goes)
// Doug James, Dinesh Pai. BD-Tree: Output-Sensitive Collision Detection for Reduced Deformable Models. SIGGRAPH 2004
// (spheres that are valid for a whole family of deformations)
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/surface.hpp>

namespace grapeshot {

/// Four balls side by side, those that exist first. One cache line.
struct alignas(16) FourBalls {
    float center[3][4];  ///< m
    float radius[4];     ///< m
};

/// What a slot holds: an inner node or a leaf.
using BallRef = std::uint32_t;
inline constexpr BallRef noBall = 0xffffffffU;
inline constexpr BallRef ballLeafBit = 0x80000000U;
[[nodiscard]] constexpr bool isBallLeaf(BallRef ref) noexcept {
    return (ref & ballLeafBit) != 0U;
}
[[nodiscard]] constexpr std::uint32_t ballIndex(BallRef ref) noexcept {
    return ref & ~ballLeafBit;
}

/// The ball of a piece by itself.
struct PieceBall {
    std::uint32_t center = 0;  ///< a vertex of the mesh, usually of the piece
    float radius = 0;          ///< largest distance along edges at rest from the centre to a corner of the piece, m,
                               ///< rounded up; infinite if the piece is not connected
    float restRadius = 0;      ///< largest distance at rest from the centre to a centroid of the triangles, m
    /// A ball around the piece at rest, wherever its middle is: smaller, and good for a body that moves as a whole.
    float plainCenter[3] = {}, plainRadius = 0;  ///< m
};

/// Up to four pieces of a piece. Empty slots stand last and have child noBall.
struct BallNode {
    PieceBall own;            ///< of the root: infinite
    std::uint32_t center[4];  ///< as the children's own
    float radius[4];
    BallRef child[4];
    std::uint32_t count;  ///< 1..4
};

/// Up to sixteen triangles. Unused lanes repeat lane 0 and have triangle noTriangle.
struct BallLeaf {
    std::uint32_t triangle[16];
    std::uint32_t corner[3][16];
    float middle[3][16];  ///< centroids at rest
    PieceBall own;
    std::uint32_t count;  ///< 1..16
};

/// A value; share it between threads for reading. `nodes[0]` is the root. About 60 bytes a triangle, 90 more for the
/// surface.
struct BallTree {
    Surface surface;
    std::vector<BallNode> nodes;        ///< children stand after their parents
    std::vector<FourBalls> restBalls;   ///< per node and slot: ball at rest around the triangles' centroids, by plain
                                        ///< distance from the slot's centre; for leaving out neighbourhoods
    std::vector<FourBalls> plainBalls;  ///< per node and slot: as the children's own (PieceBall::plainCenter)
    std::vector<BallLeaf> leaves;
    std::vector<std::uint32_t> leafOfTriangle;
    IndexLists leafVertices;  ///< distinct corners of each leaf
    float extent = 0;         ///< m, largest distance of a vertex from the rest frame's origin

    [[nodiscard]] const PieceBall& own(BallRef ref) const {
        return isBallLeaf(ref) ? leaves[ballIndex(ref)].own : nodes[ballIndex(ref)].own;
    }
};

/// Splits at medians of the difference of the distances from both ends of a piece, so that leaves are full; pieces that
/// are not connected are first told apart. Deterministic. O(n log n), about 5 us a triangle.
/// @throws Error as makeSurface does
[[nodiscard]] BallTree buildBallTree(MeshView rest);

/// What is malformed, in words; empty if nothing is. For tests and debugging: every triangle in one leaf, every radius
/// at least the true distance along edges. O(n^2) at worst: each ball's distances are measured.
[[nodiscard]] std::vector<std::string> findings(const BallTree& tree);

}  // namespace grapeshot
