// A tree over a hierarchy that somebody else built: its groups of triangles, with our boxes, slabs and distributions.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/adb/tree.hpp>

namespace grapeshot {

/// Two nodes, or a leaf: which is one if `left` and `right` are both 0 (the root is below nobody).
struct ForeignNode {
    std::uint32_t left = 0;  ///< index of a node
    std::uint32_t right = 0;
    std::uint32_t begin = 0;  ///< a leaf's triangles are [begin, end) of ForeignHierarchy::triangles, at least one;
    std::uint32_t end = 0;    ///< not looked at in other nodes
};

/// Who is together with whom, and nothing else: boxes are made anew. In any order; what the root does not lead to
/// (spare entries of a pool) is ignored.
struct ForeignHierarchy {
    std::vector<ForeignNode> nodes;        ///< nodes[0] is the root
    std::vector<std::uint32_t> triangles;  ///< by index in MeshView::triangles; each in exactly one leaf
};

/// The tree that keeps the hierarchy's splits: every node of it has below it what one of the hierarchy's nodes has.
/// Groups of up to four triangles become leaves, and of nested groups those are left out whose parts fit better into
/// the node above. Larger leaves, and groups that are still larger at level 48, are split further as `build` does; so a
/// chain is no deeper than any other tree. Deterministic, no recursion.
/// Worth it where the hierarchy has to be kept: building anew gives a better tree. The default calibration is fitted to
/// built trees, and was seen to hold over Bullet's hierarchies too (README.md has the numbers).
/// O(n), but for the slabs (a look at every triangle once a level, as in a refit) and for what is split further.
/// @throws Error as requireUsable does; tooLarge; indexOutOfRange (a node, a leaf's range or a triangle that does not
/// exist); badHierarchy (no nodes, a node reached twice, a leaf without triangles, a triangle in two leaves or in none)
[[nodiscard]] Tree augment(MeshView mesh, const ForeignHierarchy& hierarchy);

}  // namespace grapeshot
