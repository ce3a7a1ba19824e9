#include <grapeshot/adb/reference/grid_cells.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <grapeshot/adb/reference/polygon_clipping.hpp>

namespace grapeshot::reference {

double maxArea(const Eigen::Vector3d& sides) {
    Eigen::Vector3d sorted = sides;
    std::sort(sorted.begin(), sorted.end());
    return sorted[2] * std::hypot(sorted[0], sorted[1]);
}

GridAreas::GridAreas(const Box& box, int grid)
    : m_box(box), m_grid(grid), m_areas(static_cast<std::size_t>(grid) * grid * grid, 0.0) {
    assert(grid >= 1);
}

void GridAreas::add(const std::array<Eigen::Vector3d, 3>& triangle) {
    ConvexPolygon whole;
    for (const Eigen::Vector3d& corner : triangle) {
        whole.add(corner);
    }
    const Range xs = cellsAlong(0, triangle);
    const Range ys = cellsAlong(1, triangle);
    const Range zs = cellsAlong(2, triangle);
    const auto cut = [&](const ConvexPolygon& polygon, int axis, int index) {
        return cutToSlab(polygon, axis, plane(axis, index), plane(axis, index + 1), index + 1 == m_grid);
    };
    for (int z = zs.first; z <= zs.last; ++z) {
        const ConvexPolygon layer = cut(whole, 2, z);
        for (int y = ys.first; y <= ys.last && layer.count > 2; ++y) {
            const ConvexPolygon row = cut(layer, 1, y);
            for (int x = xs.first; x <= xs.last && row.count > 2; ++x) {
                const int cell = (z * m_grid + y) * m_grid + x;
                m_areas[static_cast<std::size_t>(cell)] += area(cut(row, 0, x));
            }
        }
    }
}

int GridAreas::wellFilled(double tau) const {
    const double least = tau * maxArea(m_box.sides() / m_grid);
    return static_cast<int>(std::ranges::count_if(m_areas, [&](double filled) { return filled >= least; }));
}

GridAreas::Range GridAreas::cellsAlong(int axis, const std::array<Eigen::Vector3d, 3>& triangle) const {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    if (high < m_box.lower[axis] || low > m_box.upper[axis]) {
        return {0, -1};
    }
    const double perMetre = m_grid / (m_box.upper[axis] - m_box.lower[axis]);
    // One to spare on either side: the planes are computed by another formula, and the cut decides.
    const auto cell = [&](double x) { return std::floor(std::clamp((x - m_box.lower[axis]) * perMetre, -1.0, 1e6)); };
    return {std::max(0, static_cast<int>(cell(low)) - 1), std::min(m_grid - 1, static_cast<int>(cell(high)) + 1)};
}

double GridAreas::plane(int axis, int index) const {
    if (index == m_grid) {
        return m_box.upper[axis];
    }
    return m_box.lower[axis] + index * (m_box.upper[axis] - m_box.lower[axis]) / m_grid;
}

}  // namespace grapeshot::reference
