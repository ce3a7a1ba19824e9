#include <grapeshot/plugin/detail/surface_pass.hpp>

#include <Eigen/Geometry>
#include <array>
#include <optional>

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
    if (!meet(point, triangle, m_distance)) {
        return;
    }
    if (const auto crossing = crossingOf(point, triangle)) {
        m_corners.push_back({body, corner, face, own, true, crossing->time, crossing->weights, crossing->normal, 1});
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
    if (!meet(first, second, m_distance)) {
        return;
    }
    if (const auto crossing = crossingOf(first, second)) {
        m_edges.push_back({ends, pair, true, crossing->time, crossing->first, crossing->second, crossing->normal});
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
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
