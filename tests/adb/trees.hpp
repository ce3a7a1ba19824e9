// What tests of this room ask of whole trees.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>
#include <support/same_bytes.hpp>

namespace grapeshot::test {

/// Levels of nodes, by descent.
inline std::size_t depthOf(const Tree& tree) {
    std::vector<std::size_t> levels(tree.nodes.size(), 1);
    std::size_t deepest = 1;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        for (const ChildRef child : tree.nodes[i].child) {
            if (!isLeaf(child)) {
                levels[child] = levels[i] + 1;
                deepest = std::max(deepest, levels[child]);
            }
        }
    }
    return deepest;
}

/// Distance below which rounding decides whether two triangles touch, m.
inline double borderline(const Tree& a, const Tree& b, const Pose& pose) {
    return 1e-6 * (double{a.radius} + b.radius + pose.translation.cast<double>().norm());
}

}  // namespace grapeshot::test
