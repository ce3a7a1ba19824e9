#include <grapeshot/narrowphase/detail/point_contacts.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/Geometry>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/narrowphase/detail/closest_on_triangle.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>

namespace grapeshot::detail {

using Eigen::Vector3f;

void Candidates::inBox(const MeshModel& mesh, const Vector3f& lower, const Vector3f& upper) {
    m_leaves.clear();
    if (m_choice != nullptr) {
        const SearchRegion region = SearchRegion::inBox(lower, upper);
        std::ranges::copy_if(m_choice->leaves, std::back_inserter(m_leaves),
                             [&](std::uint32_t leaf) { return region.touches(mesh.leafShapes[leaf]); });
    } else {
        leavesInBox(mesh.tree, lower, upper, m_leaves);
    }
    unpack(mesh);
}

void Candidates::belowPlane(const MeshModel& mesh, const Vector3f& normal, float offset) {
    m_leaves.clear();
    if (m_choice != nullptr) {
        m_leaves.assign(m_choice->leaves.begin(), m_choice->leaves.end());
    } else {
        leavesBelowPlane(mesh.tree, normal, offset, m_leaves);
    }
    unpack(mesh);
}

void Candidates::unpack(const MeshModel& mesh) {
    m_triangles.clear();
    for (const std::uint32_t leaf : m_leaves) {
        for (const std::uint32_t triangle : mesh.tree.leaves[leaf].triangle) {
            if (triangle != noTriangle) {
                m_triangles.push_back(triangle);
            }
        }
    }
}

std::uint64_t meshFeatureKey(const MeshModel& mesh, std::uint32_t triangle, int feature) {
    if (feature == 6) {
        return faceKey(triangle);
    }
    const auto index = static_cast<unsigned>(feature % 3);
    const Triangle& corner = mesh.tree.triangles[triangle];
    const std::uint32_t vertex = mesh.topology.welded[corner[index]];
    return feature < 3 ? cornerKey(vertex) : edgeKey(vertex, mesh.topology.welded[corner[(index + 1) % 3]]);
}

float coordinateRounding(float extent) {
    return std::ldexp(extent, -22);
}

ConvexScratch& convexScratch(LeafChoice* choice) {
    thread_local ConvexScratch scratch;
    scratch.candidates.confineTo(choice);
    scratch.collector.clear();
    return scratch;
}

namespace {

/// A feature that is locally closest to the centre.
struct Nearest {
    Vector3f point;
    Vector3f towardsCenter;  // unit
    float distance = std::numeric_limits<float>::infinity();
    bool inside = false;  // the centre is on the solid's side of it
    std::uint32_t triangle = noTriangle;
    std::uint64_t key = 0;
};

bool locallyClosest(const MeshModel& mesh, const Vector3f& center, std::uint32_t triangle, const Vector3f& point,
                    int feature, float rounding, Nearest& out) {
    const Vector3f outer = pseudonormal(mesh, triangle, feature);
    out.point = point;
    out.triangle = triangle;
    out.distance = (center - point).norm();
    const float side = (center - point).dot(outer);
    out.inside = mesh.solid && side < 0;
    if (feature == 6 && !outer.isZero()) {
        out.towardsCenter = side < 0 ? Vector3f(-outer) : outer;
        return true;
    }
    if (out.distance < 8 * rounding) {  // on the surface: no direction of its own
        const float length = outer.norm();
        out.towardsCenter = length > 0 ? Vector3f(outer / length) : Vector3f(Vector3f::UnitY());
        out.inside = false;
        return length > 0;
    }
    out.towardsCenter = (center - point) / out.distance;
    const float lean = std::min(0.1F, 1e-3F + rounding / out.distance);
    return feature >= 3 ? edgeIsExtremal(mesh, triangle, static_cast<unsigned>(feature - 3), out.towardsCenter, lean)
                        : cornerIsExtremal(mesh, mesh.topology.welded[mesh.tree.triangles[triangle][feature]],
                                           out.towardsCenter, lean);
}

/// Is nothing of the ball's body deeper than its centre, along the contact's normal?
bool deepestOfBody(const Ball& ball, const Vector3f& normal, float lean) {
    return std::none_of(ball.body.begin(), ball.body.end(),
                        [&](const Vector3f& direction) { return direction.dot(normal) > lean; });
}

void addOutside(const Ball& ball, const Nearest& nearest, float maxDistance, float lean, ContactCollector& out) {
    const Vector3f normal = -nearest.towardsCenter;
    const float distance = (nearest.point - ball.center).dot(normal) - ball.radius;
    if (distance <= maxDistance && deepestOfBody(ball, normal, lean)) {
        out.add({nearest.key, ball.key},
                {nearest.point, nearest.point - distance * normal, normal, distance, nearest.triangle, noTriangle});
    }
}

bool nearestOfAll(const MeshModel& mesh, const Vector3f& center, float rounding, Nearest& out) {
    const auto closest = closestPoint(mesh.tree, center, std::numeric_limits<float>::infinity());
    if (!closest || !locallyClosest(mesh, center, closest->triangle, closest->point, closest->feature, rounding, out)) {
        return false;
    }
    out.key = meshFeatureKey(mesh, closest->triangle, closest->feature);
    return true;
}

void addInside(const Ball& ball, const Nearest& nearest, ContactCollector& out) {
    const Vector3f& normal = nearest.towardsCenter;
    const float distance = (nearest.point - ball.center).dot(normal) - ball.radius;
    out.add({nearest.key, ball.key},
            {nearest.point, nearest.point - distance * normal, normal, distance, nearest.triangle, noTriangle});
}

}  // namespace

std::uint64_t pointContacts(const MeshModel& mesh, const Ball& ball, float maxDistance,
                            const LocalContactSettings& settings, Candidates& candidates, ContactCollector& out) {
    const float reach = ball.radius + maxDistance;
    const Vector3f lower = ball.center.array() - reach;
    const Vector3f upper = ball.center.array() + reach;
    if ((lower.array() > mesh.tree.upper.array()).any() || (upper.array() < mesh.tree.lower.array()).any()) {
        return 0;
    }
    const float rounding = coordinateRounding(mesh.tree.radius + ball.center.norm());
    candidates.inBox(mesh, lower, upper);
    std::uint64_t work = candidates.work();

    // First the nearest point of all: it alone tells inside from outside.
    Nearest nearest;
    for (const std::uint32_t triangle : candidates.triangles()) {
        const OnTriangle closest = closestOnTriangle(mesh, triangle, ball.center);
        const float distance = (closest.point - ball.center).norm();
        if (distance < nearest.distance || (distance == nearest.distance && triangle < nearest.triangle)) {
            Nearest candidate;
            if (locallyClosest(mesh, ball.center, triangle, closest.point, closest.feature, rounding, candidate)) {
                nearest = candidate;
                nearest.key = meshFeatureKey(mesh, triangle, closest.feature);
            }
        }
    }
    LeafChoice* choice = candidates.choice();
    const bool elsewhere = choice != nullptr && !choice->all;
    if (mesh.solid && (elsewhere || !(nearest.distance <= reach))) {
        if (choice != nullptr && !choice->pay(1)) {
            return work;
        }
        ++work;
        if (!nearestOfAll(mesh, ball.center, rounding, nearest)) {
            return work;
        }
    }
    if (!(nearest.distance <= reach)) {
        if (nearest.inside && deepestOfBody(ball, nearest.towardsCenter, settings.lean) &&
            out.isNew({nearest.key, ball.key}, nearest.triangle, noTriangle)) {
            addInside(ball, nearest, out);
        }
        return work;
    }

    const bool inside = nearest.inside;
    Nearest wayOut;
    for (const std::uint32_t triangle : candidates.triangles()) {
        const OnTriangle closest = closestOnTriangle(mesh, triangle, ball.center);
        if (!((closest.point - ball.center).squaredNorm() <= reach * reach)) {
            continue;
        }
        Nearest found;
        found.key = meshFeatureKey(mesh, triangle, closest.feature);
        if (!out.isNew({found.key, ball.key}, triangle, noTriangle) ||
            !locallyClosest(mesh, ball.center, triangle, closest.point, closest.feature, rounding, found) ||
            found.inside != inside) {
            continue;
        }
        if (!inside) {
            addOutside(ball, found, maxDistance, settings.lean, out);
        } else if ((found.distance < wayOut.distance ||
                    (found.distance == wayOut.distance && found.key < wayOut.key)) &&
                   deepestOfBody(ball, found.towardsCenter, settings.lean)) {
            wayOut = found;
        }
    }
    if (inside && wayOut.triangle != noTriangle) {
        addInside(ball, wayOut, out);
    }
    return work;
}

}  // namespace grapeshot::detail
