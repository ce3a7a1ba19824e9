#include "depth_oracle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/core/topology.hpp>

namespace grapeshot::test {
namespace {

double pointToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d (&c)[3]) {
    const Eigen::Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
    bool isAbove = normal.squaredNorm() > 0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d edge = c[(i + 1) % 3] - c[i];
        isAbove = isAbove && normal.cross(edge).dot(p - c[i]) >= 0;
        const double length = edge.squaredNorm();
        const double t = length > 0 ? std::clamp((p - c[i]).dot(edge) / length, 0.0, 1.0) : 0;
        least = std::min(least, (p - c[i] - t * edge).norm());
    }
    return isAbove ? std::abs(normal.normalized().dot(p - c[0])) : least;
}

class Sets {
  public:
    explicit Sets(std::size_t count) : m_parent(count) { std::iota(m_parent.begin(), m_parent.end(), 0U); }
    std::size_t find(std::size_t i) {
        while (m_parent[i] != i) {
            i = m_parent[i] = m_parent[m_parent[i]];
        }
        return i;
    }
    void join(std::size_t i, std::size_t j) { m_parent[find(i)] = find(j); }

  private:
    std::vector<std::size_t> m_parent;
};

struct Side {
    explicit Side(MeshView mesh, const Pose& pose) : topology(buildTopology(mesh)), triangles(mesh.triangles) {
        for (const Eigen::Vector3f& vertex : mesh.vertices) {
            vertices.emplace_back(pose.rotation.cast<double>() * vertex.cast<double>() +
                                  pose.translation.cast<double>());
        }
    }
    Topology topology;
    std::span<const Triangle> triangles;
    std::vector<Eigen::Vector3d> vertices;
    std::vector<char> inside;

    /// @param contains (vertex) -> bool, of those in the box around the other
    template <class Contains>
    void compare(const Side& other, const Contains& contains) {
        Eigen::Vector3d low = other.vertices[0];
        Eigen::Vector3d high = low;
        for (const Eigen::Vector3d& vertex : other.vertices) {
            low = low.cwiseMin(vertex);
            high = high.cwiseMax(vertex);
        }
        inside.assign(vertices.size(), 0);
        for (std::uint32_t v = 0; v < vertices.size(); ++v) {
            if (topology.welded[v] == v && !topology.ringOf(v).empty() && (vertices[v].array() > low.array()).all() &&
                (vertices[v].array() < high.array()).all()) {
                inside[v] = contains(v) ? 1 : 0;
            }
        }
    }
};

/// @param depthOf (side, vertex) -> m, of those that are inside
template <class DepthOf>
std::vector<TrueRegion> regionsOfSides(const Side (&sides)[2], std::span<const TrianglePair> cuts,
                                       const DepthOf& depthOf) {
    // Vertices of A, vertices of B, cuts.
    const std::size_t countA = sides[0].vertices.size();
    const std::size_t offset[3] = {0, countA, countA + sides[1].vertices.size()};
    Sets sets(offset[2] + cuts.size());
    for (std::size_t s = 0; s < 2; ++s) {
        for (std::uint32_t v = 0; v < sides[s].inside.size(); ++v) {
            for (const std::uint32_t w :
                 sides[s].inside[v] != 0 ? sides[s].topology.ringOf(v) : std::span<const std::uint32_t>()) {
                if (sides[s].inside[w] != 0) {
                    sets.join(offset[s] + v, offset[s] + w);
                }
            }
        }
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> cutAt;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const std::uint32_t triangle[2] = {cuts[i].triangleA, cuts[i].triangleB};
        for (std::size_t s = 0; s < 2; ++s) {
            for (const std::uint32_t corner : sides[s].triangles[triangle[s]]) {
                const std::uint32_t v = sides[s].topology.welded[corner];
                if (sides[s].inside[v] != 0) {
                    sets.join(offset[2] + i, offset[s] + v);
                }
            }
        }
        for (const std::uint32_t v : sides[0].triangles[triangle[0]]) {
            for (const std::uint32_t w : sides[1].triangles[triangle[1]]) {
                const auto [place, isNew] =
                    cutAt.try_emplace({sides[0].topology.welded[v], sides[1].topology.welded[w]}, i);
                if (!isNew) {
                    sets.join(offset[2] + i, offset[2] + place->second);
                }
            }
        }
    }
    std::map<std::size_t, TrueRegion> regions;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        regions[sets.find(offset[2] + i)].cuts.push_back(cuts[i]);
    }
    for (std::size_t s = 0; s < 2; ++s) {
        for (std::uint32_t v = 0; v < sides[s].inside.size(); ++v) {
            if (sides[s].inside[v] != 0) {
                TrueRegion& region = regions[sets.find(offset[s] + v)];
                (s == 0 ? region.insideA : region.insideB).push_back(v);
                region.depth = std::max(region.depth, depthOf(s, v));
            }
        }
    }
    std::vector<TrueRegion> result;
    for (auto& [root, region] : regions) {
        result.push_back(std::move(region));
    }
    return result;
}

}  // namespace

bool isInside(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles,
              const Eigen::Vector3d& point) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const Eigen::Vector3d a = vertices[t[0]] - point;
        const Eigen::Vector3d b = vertices[t[1]] - point;
        const Eigen::Vector3d c = vertices[t[2]] - point;
        const double la = a.norm();
        const double lb = b.norm();
        const double lc = c.norm();
        sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return std::abs(sum) > 2 * 3.141592653589793;
}

double distanceTo(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles,
                  const Eigen::Vector3d& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) {
        least = std::min(least, pointToTriangle(point, {vertices[t[0]], vertices[t[1]], vertices[t[2]]}));
    }
    return least;
}

std::vector<TrueRegion> trueRegions(MeshView a, MeshView b, const Pose& bInA, std::span<const TrianglePair> cuts) {
    Side sides[2] = {Side(a, {}), Side(b, bInA)};
    for (int s = 0; s < 2; ++s) {
        const Side& other = sides[1 - s];
        sides[s].compare(
            other, [&](std::uint32_t v) { return isInside(other.vertices, other.triangles, sides[s].vertices[v]); });
    }
    return regionsOfSides(sides, cuts, [&](std::size_t s, std::uint32_t v) {
        return distanceTo(sides[1 - s].vertices, sides[1 - s].triangles, sides[s].vertices[v]);
    });
}

std::vector<TrueRegion> trueRegions(const Tree& a, const Tree& b, const Pose& bInA,
                                    std::span<const TrianglePair> cuts) {
    Side sides[2] = {Side({a.vertices, a.triangles}, {}), Side({b.vertices, b.triangles}, bInA)};
    const Pose aInB = inverse(bInA);
    const auto inOther = [&](std::size_t s, std::uint32_t v) {
        return s == 0 ? apply(aInB, a.vertices[v]) : apply(bInA, b.vertices[v]);
    };
    for (std::size_t s = 0; s < 2; ++s) {
        sides[s].compare(sides[1 - s], [&](std::uint32_t v) { return contains(s == 0 ? b : a, inOther(s, v)); });
    }
    return regionsOfSides(sides, cuts, [&](std::size_t s, std::uint32_t v) {
        const auto closest = closestPoint(s == 0 ? b : a, inOther(s, v), std::numeric_limits<float>::max());
        return closest ? static_cast<double>(closest->distance) : 0;
    });
}

}  // namespace grapeshot::test
