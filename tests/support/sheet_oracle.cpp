#include "sheet_oracle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace grapeshot::test {

using Eigen::Vector3d;

namespace {

constexpr int planAxes[] = {0, 2};

/// Does the ray from the point along +x of the plan cross the edge? Both triangles of an edge ask for the same.
bool crossesEdge(const Vector3d* a, const Vector3d* b, const Vector3d& point) {
    if (std::pair(a->z(), a->x()) > std::pair(b->z(), b->x())) {
        std::swap(a, b);
    }
    if ((a->z() > point.z()) == (b->z() > point.z())) {
        return false;
    }
    return point.x() < a->x() + (point.z() - a->z()) / (b->z() - a->z()) * (b->x() - a->x());
}

}  // namespace

VerticalOracle::VerticalOracle(std::span<const Vector3d> vertices, std::span<const Triangle> triangles)
    : m_vertices(vertices), m_triangles(triangles) {
    m_side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(triangles.size()))));
    m_lower = Vector3d::Constant(HUGE_VAL);
    m_upper = Vector3d::Constant(-HUGE_VAL);
    for (const Vector3d& v : vertices) {
        m_lower = m_lower.cwiseMin(v);
        m_upper = m_upper.cwiseMax(v);
    }
    const auto forCells = [&](const Triangle& t, auto&& visit) {
        std::array<int, 2> first{}, last{};
        for (std::size_t i = 0; i < 2; ++i) {
            const auto [low, high] = std::minmax(
                {m_vertices[t[0]][planAxes[i]], m_vertices[t[1]][planAxes[i]], m_vertices[t[2]][planAxes[i]]});
            first[i] = cellOf(low, planAxes[i]);
            last[i] = cellOf(high, planAxes[i]);
        }
        for (int z = first[1]; z <= last[1]; ++z) {
            for (int x = first[0]; x <= last[0]; ++x) {
                visit(static_cast<std::size_t>(z) * static_cast<std::size_t>(m_side) + static_cast<std::size_t>(x));
            }
        }
    };
    m_begin.assign(static_cast<std::size_t>(m_side) * static_cast<std::size_t>(m_side) + 1, 0);
    for (const Triangle& t : triangles) {
        forCells(t, [&](std::size_t cell) { ++m_begin[cell + 1]; });
    }
    for (std::size_t cell = 1; cell < m_begin.size(); ++cell) {
        m_begin[cell] += m_begin[cell - 1];
    }
    m_inCells.resize(m_begin.back());
    std::vector<std::uint32_t> next(m_begin.begin(), m_begin.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        forCells(triangles[t], [&](std::size_t cell) { m_inCells[next[cell]++] = t; });
    }
}

int VerticalOracle::cellOf(double value, int axis) const {
    const double share = (value - m_lower[axis]) / std::max(1e-300, m_upper[axis] - m_lower[axis]);
    return std::clamp(static_cast<int>(share * m_side), 0, m_side - 1);
}

Crossings VerticalOracle::at(const Vector3d& point) const {
    Crossings crossings;
    if (!(point.x() >= m_lower.x() && point.x() <= m_upper.x() && point.z() >= m_lower.z() &&
          point.z() <= m_upper.z())) {
        return crossings;
    }
    const std::size_t cell = static_cast<std::size_t>(cellOf(point.z(), 2)) * static_cast<std::size_t>(m_side) +
                             static_cast<std::size_t>(cellOf(point.x(), 0));
    for (std::uint32_t i = m_begin[cell]; i < m_begin[cell + 1]; ++i) {
        const Triangle& t = m_triangles[m_inCells[i]];
        const Vector3d& a = m_vertices[t[0]];
        const Vector3d& b = m_vertices[t[1]];
        const Vector3d& c = m_vertices[t[2]];
        if ((crossesEdge(&a, &b, point) != crossesEdge(&b, &c, point)) == crossesEdge(&c, &a, point)) {
            continue;
        }
        const Vector3d normal = (b - a).cross(c - a);
        const double height =
            a.y() - (normal.x() * (point.x() - a.x()) + normal.z() * (point.z() - a.z())) / normal.y();
        ++(height > point.y() + 1e-12 ? crossings.above : crossings.below);
    }
    return crossings;
}

int pointsBelow(const VerticalOracle& sheet, std::span<const Vector3d> points) {
    return static_cast<int>(
        std::ranges::count_if(points, [&](const Vector3d& point) { return sheet.at(point).above % 2 != 0; }));
}

int pointsAbove(const VerticalOracle& sheet, std::span<const Vector3d> points) {
    return static_cast<int>(
        std::ranges::count_if(points, [&](const Vector3d& point) { return sheet.at(point).below % 2 != 0; }));
}

}  // namespace grapeshot::test
