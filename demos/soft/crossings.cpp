#include "crossings.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace grapeshot::soft {

using Eigen::Vector3d;

namespace {

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

struct Grid {
    double size = 1;                                               ///< of a cell, m
    std::vector<std::pair<std::uint64_t, std::uint32_t>> entries;  ///< key of a cell, triangle; sorted

    [[nodiscard]] Cell cell(const Vector3d& point) const {
        return (point / size).array().floor().matrix().cast<std::int64_t>();
    }
    static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
        constexpr std::uint64_t mask = (1U << 21U) - 1;
        return ((static_cast<std::uint64_t>(x) & mask) << 42U) | ((static_cast<std::uint64_t>(y) & mask) << 21U) |
               (static_cast<std::uint64_t>(z) & mask);
    }
    template <class Visit>
    void cells(const Vector3d& lower, const Vector3d& upper, const Visit& visit) const {
        const Cell first = cell(lower);
        const Cell last = cell(upper);
        for (std::int64_t x = first.x(); x <= last.x(); ++x) {
            for (std::int64_t y = first.y(); y <= last.y(); ++y) {
                for (std::int64_t z = first.z(); z <= last.z(); ++z) {
                    visit(key(x, y, z));
                }
            }
        }
    }
};

/// What has blown up would fill the grid; its nodes are counted as lost.
bool isUsable(const Surface& surface, const Triangle& t) {
    constexpr double farthest = 1e3, longest = 4;  // m
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t i) {
        const Vector3d& point = surface.points[i];
        return point.allFinite() && point.cwiseAbs().maxCoeff() < farthest &&
               (point - surface.points[t[0]]).cwiseAbs().maxCoeff() < longest;
    });
}

double meanEdge(const Surface& surface) {
    double sum = 0;
    double count = 0;
    for (const Triangle& t : surface.triangles) {
        if (isUsable(surface, t)) {
            sum += (surface.points[t[0]] - surface.points[t[1]]).norm() +
                   (surface.points[t[1]] - surface.points[t[2]]).norm();
            count += 2;
        }
    }
    return count > 0 ? std::max(sum / count, 1e-3) : 1;
}

Grid gridOf(const Surface& surface) {
    Grid grid;
    grid.size = meanEdge(surface);
    for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) {
        const Triangle& t = surface.triangles[i];
        if (isUsable(surface, t)) {
            const Vector3d& a = surface.points[t[0]];
            const Vector3d& b = surface.points[t[1]];
            const Vector3d& c = surface.points[t[2]];
            grid.cells(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c),
                       [&](std::uint64_t key) { grid.entries.emplace_back(key, i); });
        }
    }
    std::sort(grid.entries.begin(), grid.entries.end());
    return grid;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> edgesOf(const Surface& surface) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : surface.triangles) {
        if (isUsable(surface, t)) {
            for (std::size_t i = 0; i < 3; ++i) {
                edges.push_back(std::minmax({t[i], t[(i + 1) % 3]}));
            }
        }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

}  // namespace

bool passesThrough(const Vector3d& from, const Vector3d& to, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d way = to - from;
    const Vector3d u = b - a;
    const Vector3d v = c - a;
    const Vector3d p = way.cross(v);
    const double det = u.dot(p);
    if (det == 0) {
        return false;
    }
    const Vector3d w = from - a;
    const double s = w.dot(p) / det;
    const Vector3d q = w.cross(u);
    const double t = way.dot(q) / det;
    const double along = v.dot(q) / det;
    return s > 0 && t > 0 && s + t < 1 && along > 0 && along < 1;
}

std::vector<CrossedEdge> crossedEdges(const Surface& edges, const Surface& faces) {
    const bool same = &edges == &faces;
    const Grid grid = gridOf(faces);
    std::vector<CrossedEdge> crossed;
    std::vector<std::uint32_t> near;
    for (const auto& [first, second] : edgesOf(edges)) {
        const Vector3d& from = edges.points[first];
        const Vector3d& to = edges.points[second];
        near.clear();
        grid.cells(from.cwiseMin(to), from.cwiseMax(to), [&](std::uint64_t key) {
            auto entry = std::lower_bound(grid.entries.begin(), grid.entries.end(), std::pair{key, std::uint32_t{0}});
            for (; entry != grid.entries.end() && entry->first == key; ++entry) {
                near.push_back(entry->second);
            }
        });
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        for (const std::uint32_t triangle : near) {
            const Triangle& t = faces.triangles[triangle];
            const bool shared = same && std::any_of(t.begin(), t.end(), [&, a = first, b = second](std::uint32_t i) {
                                    return i == a || i == b;
                                });
            if (!shared && passesThrough(from, to, faces.points[t[0]], faces.points[t[1]], faces.points[t[2]])) {
                crossed.push_back({first, second, triangle});
            }
        }
    }
    return crossed;
}

std::size_t crossings(const Surface& edges, const Surface& faces) {
    return crossedEdges(edges, faces).size();
}

std::size_t crossingsOfBoth(const Surface& a, const Surface& b) {
    return crossings(a, b) + crossings(b, a);
}

}  // namespace grapeshot::soft
