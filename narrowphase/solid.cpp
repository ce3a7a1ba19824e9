#include <grapeshot/narrowphase/solid.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/detail/box_cut.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot {

using Eigen::Vector3f;

bool SearchRegion::touches(const LeafShape& leaf) const {
    // Middle and extents of a leaf's box are rounded.
    constexpr float rounding = 1e-6F;
    const Vector3f slack = rounding * (leaf.center.cwiseAbs() + leaf.half);
    if (!isBox) {
        return normal.dot(leaf.center) - normal.cwiseAbs().dot(leaf.half + 2 * slack) <=
               offset + rounding * std::abs(offset);
    }
    const Vector3f half = leaf.half + slack;
    return (leaf.center - half - upper).maxCoeff() <= 0 && (lower - leaf.center - half).maxCoeff() <= 0;
}

// Plane

float PlacedPlane::distanceBound(const Vector3f& center, const Vector3f& half) const {
    return m_plane.normal.dot(center) - m_plane.normal.cwiseAbs().dot(half) - m_plane.offset;
}

std::uint64_t PlacedPlane::regions(const MeshModel&, float maxDistance, std::vector<SearchRegion>& out) const {
    out.push_back(SearchRegion::belowPlane(m_plane.normal, m_plane.offset + maxDistance));
    return 0;
}

std::uint64_t PlacedPlane::contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                                    std::vector<SurfaceContact>& out, LeafChoice* choice) const {
    return planeContacts(mesh, m_plane, maxDistance, settings, out, choice);
}

// Sphere and capsule

float PlacedCapsule::distanceBound(const Vector3f& center, const Vector3f& half) const {
    const Vector3f axis = m_capsule.to - m_capsule.from;
    const float squared = axis.squaredNorm();
    const float t = squared > 0 ? std::clamp((center - m_capsule.from).dot(axis) / squared, 0.0F, 1.0F) : 0.0F;
    if (isSphere()) {
        const Vector3f beyond = ((center - m_capsule.from).cwiseAbs() - half).cwiseMax(0.0F);
        return beyond.norm() - m_capsule.radius;
    }
    return (center - (m_capsule.from + t * axis)).norm() - half.norm() - m_capsule.radius;
}

std::uint64_t PlacedCapsule::regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const {
    const float reach = m_capsule.radius + maxDistance;
    const auto around = [&](const Vector3f& from, const Vector3f& to) {
        out.push_back(SearchRegion::inBox(from.cwiseMin(to).array() - reach, from.cwiseMax(to).array() + reach));
    };
    around(m_capsule.from, m_capsule.from);
    if (!isSphere()) {
        around(m_capsule.to, m_capsule.to);
        around(m_capsule.from, m_capsule.to);
    }
    return !mesh.solid ? 0 : isSphere() ? 1 : 2;
}

std::uint64_t PlacedCapsule::contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                                      std::vector<SurfaceContact>& out, LeafChoice* choice) const {
    return isSphere() ? sphereContacts(mesh, {m_capsule.from, m_capsule.radius}, maxDistance, settings, out, choice)
                      : capsuleContacts(mesh, m_capsule, maxDistance, settings, out, choice);
}

// Box

float boxDistanceBound(const BoxSolid& box, const Vector3f& center, const Vector3f& half) {
    // Of the two boxes' sums of extents along the solid's axes: the largest gap.
    const Vector3f inBox = box.pose.rotation.transpose() * (center - box.pose.translation);
    const Vector3f extent = box.pose.rotation.transpose().cwiseAbs() * half;
    const Vector3f gap = inBox.cwiseAbs() - box.half - extent;
    const float most = gap.maxCoeff();
    return most > 0 ? gap.cwiseMax(0.0F).norm() : most;
}

float PlacedBox::distanceBound(const Vector3f& center, const Vector3f& half) const {
    return boxDistanceBound(m_box, center, half);
}

std::uint64_t PlacedBox::regions(const MeshModel& mesh, float maxDistance, std::vector<SearchRegion>& out) const {
    return detail::boxRegions(mesh, m_box, maxDistance, out);
}

std::uint64_t PlacedBox::contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                                  std::vector<SurfaceContact>& out, LeafChoice* choice) const {
    return boxContacts(mesh, m_box, maxDistance, settings, out, choice);
}

std::uint64_t PlacedBox::standIn(const MeshModel& mesh, const RegionSettings& regions, float mostDepth,
                                 std::uint64_t work, std::vector<SurfaceContact>& out) const {
    // A mesh that goes right through has no corner in the box.
    if (!(m_box.half.minCoeff() > 0)) {
        return 0;
    }
    return standInContacts(mesh, detail::modelOfBox(m_box.half), m_box.pose, regions, mostDepth, work, out);
}

}  // namespace grapeshot
