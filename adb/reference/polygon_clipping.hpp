// Convex polygons cut by slabs along the axes.
//
// This work is based on:
// Ivan Sutherland, Gary Hodgman. Reentrant Polygon Clipping. Communications of the ACM 17(1), 1974
#pragma once

#include <Eigen/Core>
#include <array>
#include <cassert>
#include <cstddef>

namespace grapeshot::reference {

/// A triangle cut by six planes has at most nine corners; some to spare, where rounding has bent it.
struct ConvexPolygon {
    std::array<Eigen::Vector3d, 16> corners;
    int count = 0;
    void add(const Eigen::Vector3d& corner) {
        assert(count < static_cast<int>(corners.size()));
        corners[static_cast<std::size_t>(count++)] = corner;
    }
};

[[nodiscard]] double area(const ConvexPolygon& polygon);

/// What lies in low <= x[axis] <= high. A polygon that lies in the plane `high` is left to the next slab, unless this
/// is the `last`: neighbouring slabs share no area.
[[nodiscard]] ConvexPolygon cutToSlab(const ConvexPolygon& polygon, int axis, double low, double high, bool last);

}  // namespace grapeshot::reference
