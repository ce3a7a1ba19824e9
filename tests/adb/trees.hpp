// What tests of this room ask of whole trees.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

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

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()),
                                               a.size() * sizeof(T)) == 0;
}

}  // namespace grapeshot::test
