#include <grapeshot/plugin/detail/surface_pass.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

void SurfaceContacts::Pass::bringBack() {
    for (int memory = 0; memory < 2; ++memory) {
        for (const auto& [corner, anchor] : m_memory.m_anchors[static_cast<std::size_t>(memory)]) {
            const SurfaceInStep& other = *m_bodies[1 - memory];
            const Vector3d normal = (anchor.front ? 1 : -1) * normalOf(other, anchor.face, other.after);
            m_corners.push_back({memory, corner, anchor.face, anchor.own, true, -1, anchor.weights, normal, 1});
        }
    }
    for (const auto& [ends, passed] : m_memory.m_edges) {
        const auto [first, second] = movingEdges(ends, &SurfaceInStep::after, &SurfaceInStep::after);
        if (const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to})) {
            const Vector3d normal = (passed.along ? 1 : -1) * crossOf(ends, &SurfaceInStep::after).normalized();
            m_edges.push_back({ends, passed.pair, true, -1, inside->x(), inside->y(), normal});
        }
    }
}

void SurfaceContacts::Pass::testCorner(int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face) {
    const SurfaceInStep& mine = *m_bodies[body];
    const SurfaceInStep& other = *m_bodies[1 - body];
    const Moving point = {at(mine.before, corner), at(mine.after, corner)};
    const auto triangle = moving(other, face, other.before, other.after);
    if (!meet(point, triangle, m_faced != nullptr ? 0 : m_distance)) {
        return;
    }
    if (const auto crossing = crossingOf(point, triangle)) {
        m_corners.push_back({body, corner, face, own, true, crossing->time, crossing->weights, crossing->normal, 1});
        return;
    }
    if (m_faced != nullptr) {
        return;
    }
    const std::array<Vector3d, 3> end{triangle[0].to, triangle[1].to, triangle[2].to};
    const Vector3d weights = nearestOn(point.to, end);
    const Vector3d between = point.to - weights[0] * end[0] - weights[1] * end[1] - weights[2] * end[2];
    const double distance = between.norm();
    if (distance < m_distance && distance > 1e-12) {
        const Vector3d normal = between / distance;
        const double facing = normal.dot((end[1] - end[0]).cross(end[2] - end[0]).normalized());
        m_corners.push_back({body, corner, face, own, false, distance, weights, normal, facing});
    }
}

void SurfaceContacts::Pass::testEdges(const TrianglePair& pair, const EdgePair& ends) {
    const auto [first, second] = movingEdges(ends, &SurfaceInStep::before, &SurfaceInStep::after);
    if (!meet(first, second, nearEdges() ? m_distance : 0)) {
        return;
    }
    if (const auto crossing = crossingOf(first, second)) {
        m_edges.push_back({ends, pair, true, crossing->time, crossing->first, crossing->second, crossing->normal});
        return;
    }
    if (!nearEdges()) {
        return;
    }
    const auto inside = nearestInside({first[0].to, first[1].to}, {second[0].to, second[1].to});
    if (!inside) {
        return;
    }
    const Vector3d between = first[0].to + inside->x() * (first[1].to - first[0].to) - second[0].to -
                             inside->y() * (second[1].to - second[0].to);
    const double distance = between.norm();
    // Corners hold the full distance; between them edges and faces may come a little nearer.
    if (distance < slackened * m_distance && distance > 1e-12) {
        m_edges.push_back({ends, pair, false, distance, inside->x(), inside->y(), between / distance});
    }
}

void SurfaceContacts::Pass::lookAhead(std::span<const TrianglePair> pairs, std::vector<SoftSurfaceContact>& contacts) {
    for (const TrianglePair& pair : pairs) {
        forEachCorner(pair, [&](int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face) {
            if (!anchors(body).contains(corner) && !(m_bodies[body]->rigid && isMisplaced(face))) {
                testCorner(body, corner, own, face);
            }
        });
        forEachEdgePair(pair, [&](const EdgePair& ends) {
            if (!m_memory.m_edges.contains(ends) && !isMisplaced(ends)) {
                testEdges(pair, ends);
            }
        });
    }
    bringBack();
    chooseCorners(contacts);
    chooseEdges(contacts);
    if (m_faced != nullptr) {
        takeFaced(contacts);
    }
}

double SurfaceContacts::Pass::facingOf(const SurfaceInStep& body, std::uint32_t face, const Vector3d& weights,
                                       const Vector3d& to) const {
    double best = to.dot(normalOf(body, face, body.after));
    const Triangle& corners = body.triangles[face];
    for (std::size_t i = 0; i < 3 && std::abs(best) < 0.5; ++i) {
        if (weights[static_cast<int>(i)] > 0.999 || weights.minCoeff() < 1e-9) {
            for (const std::uint32_t other : body.surface->fan.of(corners[i])) {
                const bool holdsFoot = std::ranges::all_of(std::array{0, 1, 2}, [&](int k) {
                    return weights[k] < 1e-9 ||
                           std::ranges::find(body.triangles[other], corners[static_cast<std::size_t>(k)]) !=
                               body.triangles[other].end();
                });
                const double facing = holdsFoot ? to.dot(normalOf(body, other, body.after)) : 0;
                best = std::abs(facing) > std::abs(best) ? facing : best;
            }
        }
    }
    return best;
}

void SurfaceContacts::Pass::takeFaced(std::vector<SoftSurfaceContact>& contacts) const {
    for (int body = 0; body < 2; ++body) {
        const SurfaceInStep& mine = *m_bodies[body];
        const SurfaceInStep& other = *m_bodies[1 - body];
        const auto& misplaced = anchors(body);
        for (const FacingPlace& place : body == 0 ? m_faced->ofA : m_faced->ofB) {
            if (misplaced.contains(place.vertex) ||
                std::ranges::binary_search(m_passing, std::pair(body, place.vertex))) {
                continue;
            }
            const Triangle& face = other.triangles[place.triangle];
            const std::array<Vector3d, 3> end{at(other.after, face[0]), at(other.after, face[1]),
                                              at(other.after, face[2])};
            const Vector3d point = at(mine.after, place.vertex);
            CornerHit hit{body,
                          place.vertex,
                          place.triangle,
                          mine.surface->fan.of(place.vertex).front(),
                          false,
                          0,
                          nearestOn(point, end),
                          {},
                          1};
            const Vector3d between =
                point - hit.weights[0] * end[0] - hit.weights[1] * end[1] - hit.weights[2] * end[2];
            const double distance = between.norm();
            if (!(distance > 1e-12)) {
                continue;
            }
            hit.normal = between / distance;
            if (other.solid && facingOf(other, place.triangle, hit.weights, hit.normal) < 0) {
                hit.normal = -hit.normal;
            }
            emit(hit, contacts);
        }
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
