#include <grapeshot/scf/detail/surface_probe.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <grapeshot/core/detail/closest_on_triangle.hpp>

namespace grapeshot::detail {
namespace {

constexpr int longestWalk = 256;  // triangles
constexpr int largestFan = 4096;
constexpr double leastBesideBorder = 0.5;  // cosine to the normal: else a point is past the border, on neither side

/// The angle between two edges, rad, to 7e-5 (Abramowitz and Stegun 4.4.45): the last bits of a library's arc cosine
/// depend on the machine, and a weight need not be exact.
double weightOfAngle(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    const double lengths = std::sqrt(u.squaredNorm() * v.squaredNorm());
    if (!(lengths > 0)) {
        return 0;
    }
    const double cosine = std::clamp(u.dot(v) / lengths, -1.0, 1.0);
    const double x = std::abs(cosine);
    const double arc = std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
    return cosine >= 0 ? arc : 3.14159265358979 - arc;
}

}  // namespace

Eigen::Vector3d SurfaceProbe::normalOf(std::uint32_t triangle) const {
    const Eigen::Vector3d first = corner(triangle, 0);
    const Eigen::Vector3d normal = (corner(triangle, 1) - first).cross(corner(triangle, 2) - first);
    const double length = normal.norm();
    return length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

template <class Use>
bool SurfaceProbe::around(std::uint32_t triangle, unsigned corner, Use&& use) const {
    const std::vector<Triangle>& triangles = m_tree->tree().surface.triangles;
    const std::uint32_t vertex = m_topology->welded[triangles[triangle][corner]];
    const auto placeIn = [&](std::uint32_t t) {
        for (unsigned i = 0; i < 2; ++i) {
            if (m_topology->welded[triangles[t][i]] == vertex) {
                return i;
            }
        }
        return 2U;
    };
    use(triangle, corner);
    // Over the edges that begin at the vertex; from a border on over those that end there.
    for (const unsigned edge : {0U, 2U}) {
        std::uint32_t at = triangle;
        unsigned place = corner;
        for (int count = 0; count < largestFan; ++count) {
            at = m_topology->across[at][(place + edge) % 3];
            if (at == triangle) {
                return false;
            }
            if (at == noNeighbour) {
                break;
            }
            place = placeIn(at);
            use(at, place);
        }
    }
    return true;
}

Foot SurfaceProbe::footOn(std::uint32_t triangle, const Eigen::Vector3d& point) const {
    const PointOnTriangle on = closestOnTriangle(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2), point);
    return {on.point, (on.point - point).norm(), triangle, on.feature};
}

Foot SurfaceProbe::walk(std::uint32_t from, const Eigen::Vector3d& point, std::uint64_t& work) const {
    Foot best = footOn(from, point);
    for (int step = 0; step < longestWalk; ++step) {
        ++work;
        if (best.feature == 6) {
            break;
        }
        Foot next = best;
        const auto look = [&](std::uint32_t triangle, unsigned) {
            const Foot foot = footOn(triangle, point);
            if (foot.distance < next.distance) {
                next = foot;
            }
        };
        const auto first = static_cast<unsigned>(best.feature % 3);
        around(best.triangle, first, look);
        if (best.feature >= 3) {
            around(best.triangle, (first + 1) % 3, look);
        }
        if (!(next.distance < best.distance)) {
            break;
        }
        best = next;
    }
    return best;
}

Foot SurfaceProbe::nearest(const Eigen::Vector3d& point, const Foot& known, std::uint64_t& work) {
    Foot best = known;
    m_stack.assign(1, {0, 0});
    while (!m_stack.empty()) {
        const Waiting next = m_stack.back();
        m_stack.pop_back();
        if (best.triangle != noTriangle && !(next.distance < best.distance)) {
            continue;
        }
        ++work;
        if (isBallLeaf(next.piece)) {
            const PosedLeaf& leaf = m_tree->leaf(ballIndex(next.piece));
            const BallLeaf& own = m_tree->tree().leaves[ballIndex(next.piece)];
            double squares[16];
            for (int lane = 0; lane < 16; ++lane) {
                double square = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    const double below = static_cast<double>(leaf.low[axis][lane]) - point[axis];
                    const double above = point[axis] - static_cast<double>(leaf.high[axis][lane]);
                    const double out = std::max(0.0, std::max(below, above));
                    square += out * out;
                }
                squares[lane] = square;
            }
            for (std::uint32_t lane = 0; lane < own.count; ++lane) {
                if (best.triangle == noTriangle || squares[lane] < best.distance * best.distance) {
                    const Foot foot = footOn(own.triangle[lane], point);
                    if (best.triangle == noTriangle || foot.distance < best.distance) {
                        best = foot;
                    }
                }
            }
            continue;
        }
        const BallNode& node = m_tree->node(ballIndex(next.piece));
        const FourBalls& balls = m_tree->balls(ballIndex(next.piece));
        const std::size_t first = m_stack.size();
        for (std::uint32_t slot = 0; slot < node.count; ++slot) {
            const Eigen::Vector3d center(static_cast<double>(balls.center[0][slot]),
                                         static_cast<double>(balls.center[1][slot]),
                                         static_cast<double>(balls.center[2][slot]));
            const double distance = (center - point).norm() - static_cast<double>(balls.radius[slot]);
            if (best.triangle == noTriangle || distance < best.distance) {
                m_stack.push_back({distance, node.child[slot]});
            }
        }
        std::sort(m_stack.begin() + static_cast<std::ptrdiff_t>(first), m_stack.end(),
                  [](const Waiting& x, const Waiting& y) {
                      return x.distance != y.distance ? x.distance > y.distance : x.piece > y.piece;
                  });
    }
    return best;
}

SurfaceProbe::Normal SurfaceProbe::normalAt(const Foot& foot) const {
    Normal normal;
    if (foot.feature == 6) {
        normal.direction = normalOf(foot.triangle);
    } else if (foot.feature >= 3) {
        const std::uint32_t other = m_topology->across[foot.triangle][static_cast<std::size_t>(foot.feature - 3)];
        normal.isOnBorder = other == noNeighbour;
        normal.direction = normalOf(foot.triangle);
        if (!normal.isOnBorder) {
            normal.direction += normalOf(other);
        }
    } else {
        normal.isOnBorder =
            around(foot.triangle, static_cast<unsigned>(foot.feature), [&](std::uint32_t t, unsigned place) {
                const Eigen::Vector3d at = corner(t, place);
                normal.direction += weightOfAngle(corner(t, place + 1) - at, corner(t, place + 2) - at) * normalOf(t);
            });
    }
    return normal;
}

int SurfaceProbe::sideOf(const Foot& foot, const Eigen::Vector3d& point) const {
    const Normal normal = normalAt(foot);
    const double along = normal.direction.dot(point - foot.point);
    const double least = normal.isOnBorder ? leastBesideBorder * normal.direction.norm() * foot.distance : 0;
    return along > least ? 1 : along < -least ? -1 : 0;
}

bool SurfaceProbe::isBeyond(const Eigen::Vector3d& point, std::uint64_t& work) const {
    ++work;
    const FourBalls& balls = m_tree->balls(0);
    for (int axis = 0; axis < 3; ++axis) {
        bool isAbove = true;
        bool isBelow = true;
        for (std::uint32_t slot = 0; slot < m_tree->node(0).count; ++slot) {
            const auto center = static_cast<double>(balls.center[axis][slot]);
            const auto radius = static_cast<double>(balls.radius[slot]);
            isAbove = isAbove && point[axis] > center + radius;
            isBelow = isBelow && point[axis] < center - radius;
        }
        if (isAbove || isBelow) {
            return true;
        }
    }
    return false;
}

}  // namespace grapeshot::detail
