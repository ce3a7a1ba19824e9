// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, section 5.1.5 (closest point of a triangle)
// Sven Woop, Carsten Benthin, Ingo Wald. Watertight Ray/Triangle Intersection. JCGT 2(1), 2013
#include <grapeshot/adb/point_query.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/leaf_corners.hpp>
#include <grapeshot/adb/detail/node_stack.hpp>

namespace grapeshot {
namespace {

using detail::cornerOf;
using Eigen::Vector3d;

struct OnTriangle {
    Vector3d point;
    std::uint8_t feature;
};

struct OnEdge {
    Vector3d point;
    double squaredDistance;
    std::uint8_t feature;
};

/// Closest point of edge `edge` (from corner `edge` to the next).
OnEdge closestOnEdge(const Vector3d (&corner)[3], int edge, const Vector3d& query) {
    const Vector3d& from = corner[edge];
    const Vector3d& to = corner[(edge + 1) % 3];
    const Vector3d along = to - from;
    const double length = along.squaredNorm();
    const double t = length > 0 ? (query - from).dot(along) / length : 0;
    OnEdge out{};
    if (t <= 0) {
        out = {from, 0, static_cast<std::uint8_t>(edge)};
    } else if (t >= 1) {
        out = {to, 0, static_cast<std::uint8_t>((edge + 1) % 3)};
    } else {
        out = {from + t * along, 0, static_cast<std::uint8_t>(3 + edge)};
    }
    out.squaredDistance = (query - out.point).squaredNorm();
    return out;
}

OnTriangle closestOnTriangle(const Vector3d (&corner)[3], const Vector3d& query) {
    const Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double squaredNormal = normal.squaredNorm();
    bool inside = squaredNormal > 0;
    for (int edge = 0; edge < 3 && inside; ++edge) {
        const Vector3d along = corner[(edge + 1) % 3] - corner[edge];
        inside = normal.cross(along).dot(query - corner[edge]) > 0;
    }
    if (inside) {
        const double height = normal.dot(query - corner[0]) / squaredNormal;
        return {query - height * normal, 6};
    }
    // Off the face (or no face): the nearest edge is the nearest part of the triangle.
    OnEdge best = closestOnEdge(corner, 0, query);
    for (int edge = 1; edge < 3; ++edge) {
        const OnEdge other = closestOnEdge(corner, edge, query);
        if (other.squaredDistance < best.squaredDistance) {
            best = other;
        }
    }
    return {best.point, best.feature};
}

/// A descent visits a child only if its key is small enough; smallest first.
struct Keyed {
    double key = 0;
    ChildRef child = noChild;
};

/// Calls visitLeaf(leaf block) for the children whose key(node, slot) is at most limit(), nearest first.
template <typename Key, typename Limit, typename VisitLeaf>
void descend(const Tree& tree, const Key& key, const Limit& limit, const VisitLeaf& visitLeaf) {
    if (tree.nodes.empty()) {
        return;
    }
    detail::NodeStack<Keyed> stack;
    stack.push({-std::numeric_limits<double>::infinity(), 0});
    while (!stack.empty()) {
        const Keyed entry = stack.pop();
        if (!(entry.key <= limit())) {
            continue;
        }
        if (isLeaf(entry.child)) {
            visitLeaf(tree.leaves[indexOf(entry.child)]);
            continue;
        }
        const Node& node = tree.nodes[entry.child];
        Keyed hits[4];
        int count = 0;
        for (int slot = 0; slot < 4; ++slot) {
            if (node.child[slot] == noChild) {
                continue;
            }
            const Keyed hit{key(node, slot), node.child[slot]};
            if (!(hit.key <= limit())) {
                continue;
            }
            int place = count++;
            for (; place > 0 && hits[place - 1].key < hit.key; --place) {
                hits[place] = hits[place - 1];
            }
            hits[place] = hit;
        }
        for (int i = 0; i < count; ++i) {
            stack.push(hits[i]);
        }
    }
}

/// A ray in Woop's sheared frame: the largest component of the direction becomes z, and the ray runs along it.
class ShearedRay {
  public:
    ShearedRay(const Vector3d& origin, const Vector3d& direction) : m_origin(origin), m_direction(direction) {
        direction.cwiseAbs().maxCoeff(&m_z);
        m_x = (m_z + 1) % 3;
        m_y = (m_z + 2) % 3;
        m_shearX = direction[m_x] / direction[m_z];
        m_shearY = direction[m_y] / direction[m_z];
    }

    struct Crossing {
        double t;
        bool backFace;
    };
    /// Edges belong to both their triangles, so nothing slips through between them.
    [[nodiscard]] std::optional<Crossing> crossing(const LeafBlock& leaf, int lane) const {
        double x[3];
        double y[3];
        double z[3];
        for (int i = 0; i < 3; ++i) {
            const Vector3d corner = cornerOf(leaf, i, lane) - m_origin;
            x[i] = corner[m_x] - m_shearX * corner[m_z];
            y[i] = corner[m_y] - m_shearY * corner[m_z];
            z[i] = corner[m_z] / m_direction[m_z];
        }
        const double u = x[2] * y[1] - y[2] * x[1];
        const double v = x[0] * y[2] - y[0] * x[2];
        const double w = x[1] * y[0] - y[1] * x[0];
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) {
            return std::nullopt;
        }
        const double sum = u + v + w;
        if (sum == 0) {
            return std::nullopt;  // seen edge-on
        }
        const double t = (u * z[0] + v * z[1] + w * z[2]) / sum;
        // The shear keeps orientation if z points along the ray: sum < 0 then says counter-clockwise, seen from behind.
        return Crossing{t, (sum < 0) == (m_direction[m_z] > 0)};
    }

    /// Where the ray enters the box of the child; infinite if it misses it.
    [[nodiscard]] double entry(const Node& node, int slot, double maxT) const {
        double from = 0;
        double to = maxT;
        for (int axis = 0; axis < 3; ++axis) {
            const double offset = double{node.center[axis][slot]} - m_origin[axis];
            // Wider by far more than the rounding of this test, which is in double.
            const double half = double{node.half[axis][slot]} * (1 + 1e-12) + std::abs(offset) * 1e-12;
            if (m_direction[axis] == 0) {
                if (std::abs(offset) > half) {
                    return std::numeric_limits<double>::infinity();
                }
                continue;
            }
            const double a = (offset - half) / m_direction[axis];
            const double b = (offset + half) / m_direction[axis];
            from = std::max(from, std::min(a, b));
            to = std::min(to, std::max(a, b));
        }
        return from <= to + std::abs(to) * 1e-12 ? from : std::numeric_limits<double>::infinity();
    }

  private:
    Vector3d m_origin;
    Vector3d m_direction;
    int m_x = 0;
    int m_y = 0;
    int m_z = 0;
    double m_shearX = 0;
    double m_shearY = 0;
};

/// How often the surface winds around the origin of the ray, counted along it.
int windingAlong(const Tree& tree, const Vector3d& origin, const Vector3d& direction) {
    const ShearedRay ray(origin, direction);
    constexpr double farthest = std::numeric_limits<double>::max();
    int winding = 0;
    descend(
        tree, [&](const Node& node, int slot) { return ray.entry(node, slot, farthest); }, [] { return farthest; },
        [&](const LeafBlock& leaf) {
            for (int lane = 0; lane < 4 && leaf.triangle[lane] != noTriangle; ++lane) {
                const auto crossing = ray.crossing(leaf, lane);
                if (crossing && crossing->t >= 0) {
                    winding += crossing->backFace ? 1 : -1;
                }
            }
        });
    return winding;
}

/// Leaves first, then the inner children in order: that is how the builder numbers leaf blocks, so the list ascends.
template <typename Touches>
void collectLeaves(const Tree& tree, const Touches& touches, std::vector<std::uint32_t>& leaves) {
    if (tree.nodes.empty()) {
        return;
    }
    detail::NodeStack<std::uint32_t> stack;
    stack.push(0);
    while (!stack.empty()) {
        const Node& node = tree.nodes[stack.pop()];
        for (int slot = 0; slot < 4; ++slot) {
            if (node.child[slot] != noChild && isLeaf(node.child[slot]) && touches(node, slot)) {
                leaves.push_back(indexOf(node.child[slot]));
            }
        }
        for (int slot = 3; slot >= 0; --slot) {
            if (!isLeaf(node.child[slot]) && touches(node, slot)) {
                stack.push(node.child[slot]);
            }
        }
    }
}

}  // namespace

std::optional<ClosestPoint> closestPoint(const Tree& tree, const Eigen::Vector3f& query, float maxDistance) {
    if (!query.allFinite() || !(maxDistance >= 0)) {
        return std::nullopt;
    }
    const Vector3d from = query.cast<double>();
    // Slightly more than the square: a surface at exactly this distance counts.
    double limit = double{maxDistance} * maxDistance * (1 + 1e-12);
    ClosestPoint best;
    double bestSquared = std::numeric_limits<double>::infinity();
    const auto key = [&](const Node& node, int slot) {
        double squared = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double out = std::abs(from[axis] - node.center[axis][slot]) - node.half[axis][slot];
            squared += out > 0 ? out * out : 0;
        }
        return squared * (1 - 1e-12);
    };
    descend(
        tree, key, [&] { return limit; },
        [&](const LeafBlock& leaf) {
            for (int lane = 0; lane < 4 && leaf.triangle[lane] != noTriangle; ++lane) {
                const Vector3d corner[3] = {cornerOf(leaf, 0, lane), cornerOf(leaf, 1, lane), cornerOf(leaf, 2, lane)};
                const OnTriangle found = closestOnTriangle(corner, from);
                const double squared = (found.point - from).squaredNorm();
                if (squared > limit || squared > bestSquared ||
                    (squared == bestSquared && leaf.triangle[lane] > best.triangle)) {
                    continue;
                }
                bestSquared = squared;
                limit = std::min(limit, squared);
                best = {found.point.cast<float>(), static_cast<float>(std::sqrt(squared)), leaf.triangle[lane],
                        found.feature};
            }
        });
    if (best.triangle == noTriangle) {
        return std::nullopt;
    }
    return best;
}

std::optional<RayHit> castRay(const Tree& tree, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                              float maxT) {
    if (!origin.allFinite() || !direction.allFinite() || direction.isZero(0) || !(maxT >= 0)) {
        return std::nullopt;
    }
    const ShearedRay ray(origin.cast<double>(), direction.cast<double>());
    RayHit best;
    double limit = maxT;
    descend(
        tree, [&](const Node& node, int slot) { return ray.entry(node, slot, limit); }, [&] { return limit; },
        [&](const LeafBlock& leaf) {
            for (int lane = 0; lane < 4 && leaf.triangle[lane] != noTriangle; ++lane) {
                const auto crossing = ray.crossing(leaf, lane);
                if (!crossing || !(crossing->t >= 0) || crossing->t > limit ||
                    (crossing->t == limit && leaf.triangle[lane] > best.triangle)) {
                    continue;
                }
                limit = crossing->t;
                best = {static_cast<float>(crossing->t), leaf.triangle[lane], crossing->backFace};
            }
        });
    if (best.triangle == noTriangle) {
        return std::nullopt;
    }
    return best;
}

bool contains(const Tree& tree, const Eigen::Vector3f& point) {
    if (!point.allFinite()) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (point[axis] < tree.lower[axis] || point[axis] > tree.upper[axis]) {
            return false;
        }
    }
    // Along no axis and no diagonal, which modelled edges like to follow.
    static const Vector3d directions[3] = {
        {0.8017837, 0.5345225, 0.2672612}, {-0.3511234, 0.8427151, -0.4081234}, {0.1372311, -0.4911373, 0.8602172}};
    int inside = 0;
    for (const Vector3d& direction : directions) {
        inside += windingAlong(tree, point.cast<double>(), direction) != 0 ? 1 : 0;
    }
    return inside >= 2;
}

void leavesInBox(const Tree& tree, const Eigen::Vector3f& lower, const Eigen::Vector3f& upper,
                 std::vector<std::uint32_t>& leaves) {
    collectLeaves(
        tree,
        [&](const Node& node, int slot) {
            for (int axis = 0; axis < 3; ++axis) {
                const double center = node.center[axis][slot];
                const double half = node.half[axis][slot];
                if (!(center - half <= upper[axis] && center + half >= lower[axis])) {
                    return false;
                }
            }
            return true;
        },
        leaves);
}

void leavesBelowPlane(const Tree& tree, const Eigen::Vector3f& normal, float offset,
                      std::vector<std::uint32_t>& leaves) {
    collectLeaves(
        tree,
        [&](const Node& node, int slot) {
            double lowest = 0;
            for (int axis = 0; axis < 3; ++axis) {
                lowest += double{normal[axis]} * node.center[axis][slot] -
                          std::abs(double{normal[axis]}) * node.half[axis][slot];
            }
            return lowest <= offset;
        },
        leaves);
}

}  // namespace grapeshot
