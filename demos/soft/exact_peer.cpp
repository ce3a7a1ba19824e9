#include "exact_peer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include <grapeshot/scf/near_vertices.hpp>
#include <report/machine.hpp>

namespace grapeshot::soft {

using Eigen::Vector3f;

namespace {

Vector3f toEigen(const btVector3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::vector<Vector3f> positionsOf(const btSoftBody& surface) {
    std::vector<Vector3f> positions;
    for (int i = 0; i < surface.m_nodes.size(); ++i) {
        positions.push_back(toEigen(surface.m_nodes[i].m_x));
    }
    return positions;
}

/// Points in cells of the radius.
class Near {
  public:
    explicit Near(float radius) : m_radius(radius) {}
    void add(const Vector3f& point) { m_points[key(cellOf(point))].push_back(point); }
    [[nodiscard]] bool has(const Vector3f& point) const {
        const Eigen::Vector3i cell = cellOf(point);
        for (int i = 0; i < 27; ++i) {
            const auto at = m_points.find(key(cell + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
            if (at == m_points.end()) {
                continue;
            }
            for (const Vector3f& other : at->second) {
                if ((other - point).norm() <= m_radius) {
                    return true;
                }
            }
        }
        return false;
    }

  private:
    [[nodiscard]] Eigen::Vector3i cellOf(const Vector3f& point) const {
        return (point / m_radius).array().floor().cast<int>().matrix();
    }
    static std::uint64_t key(const Eigen::Vector3i& cell) {
        constexpr std::uint64_t mask = (1U << 21U) - 1;
        return ((static_cast<std::uint64_t>(cell.x()) & mask) << 42U) |
               ((static_cast<std::uint64_t>(cell.y()) & mask) << 21U) | (static_cast<std::uint64_t>(cell.z()) & mask);
    }

    float m_radius;
    std::unordered_map<std::uint64_t, std::vector<Vector3f>> m_points;
};

}  // namespace

ExactPeer::ExactPeer(const btSoftBody& surface, const SelfCollision& how) {
    const std::vector<Vector3f> rest = positionsOf(surface);
    std::vector<Triangle> triangles;
    for (int i = 0; i < surface.m_faces.size(); ++i) {
        const auto corner = [&](int k) {
            return static_cast<std::uint32_t>(surface.m_faces[i].m_n[k] - &surface.m_nodes[0]);
        };
        triangles.push_back({corner(0), corner(1), corner(2)});
    }
    m_tree = std::make_unique<BallTree>(buildBallTree({rest, triangles}));
    m_tracker = std::make_unique<Tracker>(*m_tree);
    m_settings.mode = TrackMode::exact;
    m_settings.exclusion = how.exclusion;
    m_near = nearVertices(m_tree->surface, 1.5F * how.thickness);
    m_thickness = how.thickness;
}

/// As the library has it: corners that are near each other along the surface.
bool ExactPeer::areNeighbours(const TrianglePair& pair) const {
    const std::vector<Triangle>& triangles = m_tree->surface.triangles;
    return std::ranges::any_of(triangles[pair.triangleA], [&](std::uint32_t v) {
        return std::ranges::any_of(triangles[pair.triangleB],
                                   [&](std::uint32_t w) { return std::ranges::binary_search(m_near.of(v), w); });
    });
}

ExactComparison ExactPeer::compare(const btSoftBody& surface, const std::vector<SoftContact>& reported, double radius) {
    const std::vector<Vector3f> positions = positionsOf(surface);
    float way = 0;
    for (int i = 0; i < surface.m_nodes.size(); ++i) {
        way = std::max(way, static_cast<float>((surface.m_nodes[i].m_x - surface.m_nodes[i].m_q).length()));
    }
    m_settings.maxDistance = m_thickness + 2 * way;
    const double begin = report::threadCpuUs();
    m_tracker->step(SurfaceState{positions, std::nullopt, Stretch::measured(), {}}, m_settings, Budget{}, m_found);
    ExactComparison result;
    result.seconds = 1e-6 * (report::threadCpuUs() - begin);
    Near near(static_cast<float>(radius));
    for (const SoftContact& contact : reported) {
        if (contact.other != &surface) {
            continue;
        }
        Vector3f middle = Vector3f::Zero();
        for (std::size_t i = 0; i < 3; ++i) {
            if (contact.nodes[i] >= 0) {
                middle += 0.5F * contact.weights[i] * positions[static_cast<std::size_t>(contact.nodes[i])];
            }
            if (contact.otherNodes[i] >= 0) {
                middle += 0.5F * contact.otherWeights[i] * positions[static_cast<std::size_t>(contact.otherNodes[i])];
            }
        }
        near.add(middle);
    }
    for (const TrackedContact& contact : m_found.contacts) {
        if (contact.signedDistance > m_thickness || areNeighbours(contact.pair)) {
            continue;
        }
        ++result.contacts;
        result.covered += near.has(0.5F * (contact.onA + contact.onB)) ? 1 : 0;
    }
    return result;
}

}  // namespace grapeshot::soft
