// computeProb: the probability that two nodes' surfaces intersect, from what is stored and where the nodes are.
//
// This work is based on:
// Gabriel Zachmann. Collision Detection as a Fundamental Technology in VR Based Product Engineering. 2007, sections 6.3
// to 6.5
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include <grapeshot/adb/reference/hypergeometric.hpp>
#include <grapeshot/adb/reference/lower_bound.hpp>
#include <grapeshot/adb/reference/sphere.hpp>
#include <grapeshot/adb/reference/tree.hpp>

namespace grapeshot::reference {

/// s, s_A, s_B: real numbers.
struct SharedCells {
    double s = 0;
    double sA = 0;
    double sB = 0;
};

/// A node as the estimate sees it.
struct FilledNode {
    const Extent* extent;
    int wellFilled;
    int grid;  ///< cells per side
};

/// Which texts do not say; this is what their assumption (filled cells anywhere in the node) leaves. In the shared
/// volume the grid with the smaller cells counts: s = shared / h^3. A surface crosses a share of the cells that is
/// proportional to their side, so the density of the other node is scaled by h / its own side; then s_X = density_X s.
[[nodiscard]] SharedCells sharedCells(const FilledNode& a, const FilledNode& b, double sharedVolume);

/// Of two nodes at this distance of their middles.
template <class V>
[[nodiscard]] double sharedVolume(const Extent& a, const Extent& b, double distance) {
    if constexpr (std::is_same_v<V, Sphere>) {
        // The radius of the ball is half the side of the cube that its grid stands in. Both grow by the same factor, so
        // that a ball within itself shares all of its cells.
        const double lens = lensVolume(0.5 * a.sides[0], 0.5 * b.sides[0], distance);
        return lens * 6 / std::numbers::pi;
    } else {
        return intersectionVolume(a, b, distance);
    }
}

}  // namespace grapeshot::reference
