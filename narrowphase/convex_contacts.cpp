// Plane and ball; capsule_contacts.cpp and box_contacts.cpp have the others.
#include <grapeshot/narrowphase/convex_contacts.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot {

using Eigen::Vector3f;

bool LeafChoice::pay(std::uint64_t work) {
    complete = complete && purse.left().work >= work;
    if (complete) {
        purse.pay(work);
    }
    return complete;
}

std::uint64_t planeContacts(const MeshModel& mesh, const PlaneSolid& plane, float maxDistance,
                            const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                            LeafChoice* choice) {
    detail::ConvexScratch& scratch = detail::convexScratch(choice);
    scratch.candidates.belowPlane(mesh, plane.normal, plane.offset + maxDistance);
    for (const std::uint32_t triangle : scratch.candidates.triangles()) {
        const Triangle& corner = mesh.tree.triangles[triangle];
        float height[3];
        for (unsigned c = 0; c < 3; ++c) {
            height[c] = plane.normal.dot(mesh.tree.vertices[corner[c]]) - plane.offset;
        }
        for (unsigned c = 0; c < 3; ++c) {
            if (!(height[c] <= maxDistance) || (mesh.traits[triangle] & (flatCorner << c)) != 0) {
                continue;
            }
            const std::uint32_t vertex = mesh.topology.welded[corner[c]];
            const detail::FeaturePairKey key{detail::cornerKey(vertex), detail::faceKey(0)};
            const Vector3f& normal = mesh.vertexNormals[vertex];
            if (!scratch.collector.isNew(key, triangle, noTriangle) || (mesh.solid && normal.dot(plane.normal) > 0) ||
                !detail::cornerIsExtremal(mesh, vertex, -plane.normal,
                                          detail::cornerLean(mesh, vertex, settings.lean))) {
                continue;
            }
            const Vector3f& onA = mesh.tree.vertices[vertex];
            scratch.collector.add(key,
                                  {onA, onA - height[c] * plane.normal, plane.normal, height[c], triangle, noTriangle});
        }
    }
    scratch.collector.finish(1e-4F * mesh.tree.radius, out);
    return scratch.candidates.work();
}

std::uint64_t sphereContacts(const MeshModel& mesh, const SphereSolid& sphere, float maxDistance,
                             const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                             LeafChoice* choice) {
    detail::ConvexScratch& scratch = detail::convexScratch(choice);
    const detail::Ball ball{sphere.center, sphere.radius, {}, detail::faceKey(0)};
    const std::uint64_t work =
        detail::pointContacts(mesh, ball, maxDistance, settings, scratch.candidates, scratch.collector);
    scratch.collector.finish(1e-4F * std::min(mesh.tree.radius, sphere.radius), out);
    return work;
}

bool isLocalExtremum(const MeshModel& mesh, std::uint32_t triangle, int feature, const Vector3f& towardsOther,
                     const LocalContactSettings& settings) {
    if (feature == 6) {
        return detail::faceIsExtremal(mesh, triangle, towardsOther, settings.lean);
    }
    if (mesh.solid && detail::pseudonormal(mesh, triangle, feature).dot(towardsOther) < 0) {
        return false;
    }
    if (feature >= 3) {
        return detail::edgeIsExtremal(mesh, triangle, static_cast<unsigned>(feature - 3), towardsOther, settings.lean);
    }
    const std::uint32_t vertex = mesh.topology.welded[mesh.tree.triangles[triangle][static_cast<unsigned>(feature)]];
    return detail::cornerIsExtremal(mesh, vertex, towardsOther, detail::cornerLean(mesh, vertex, settings.lean));
}

}  // namespace grapeshot
