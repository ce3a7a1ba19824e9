#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3f;
using Inside = std::pair<detail::FeaturePairKey, SurfaceContact>;

/// Between the ends of a capsule's axis: against corners and edges of the mesh. (Faces are nearest at an end, or all
/// along.)
class AxisContacts {
  public:
    AxisContacts(const MeshModel& mesh, const CapsuleSolid& capsule, float maxDistance,
                 const LocalContactSettings& settings, detail::ContactCollector& out, std::vector<Inside>& inside)
        : m_mesh(mesh),
          m_capsule(capsule),
          m_maxDistance(maxDistance),
          m_settings(settings),
          m_out(out),
          m_inside(inside) {
        m_axis = capsule.to - capsule.from;
        m_squaredLength = m_axis.squaredNorm();
        m_rounding = detail::coordinateRounding(mesh.tree.radius + std::max(capsule.from.norm(), capsule.to.norm()));
    }

    void triangle(std::uint32_t triangle) {
        for (unsigned i = 0; i < 3; ++i) {
            corner(triangle, i);
            edge(triangle, i);
        }
    }

    /// Where the axis is inside the mesh, the shortest way out counts, and what agrees with it.
    void finish() {
        const auto shortest = std::max_element(m_inside.begin(), m_inside.end(), [](const auto& l, const auto& r) {
            return l.second.signedDistance < r.second.signedDistance;
        });
        for (const auto& [key, contact] : m_inside) {
            if (contact.normal.dot(shortest->second.normal) > 0.7F) {
                m_out.add(key, contact);
            }
        }
    }

  private:
    static constexpr std::uint64_t axisKey = detail::edgeKey(0, 1);

    void corner(std::uint32_t triangle, unsigned corner) {
        if ((m_mesh.traits[triangle] & (flatCorner << corner)) != 0) {
            return;
        }
        const std::uint32_t vertex = m_mesh.topology.welded[m_mesh.tree.triangles[triangle][corner]];
        const Vector3f& onA = m_mesh.tree.vertices[vertex];
        const float t = (onA - m_capsule.from).dot(m_axis) / m_squaredLength;
        const detail::FeaturePairKey key{detail::cornerKey(vertex), axisKey};
        if (!(t > 0 && t < 1) || !m_out.isNew(key, triangle, noTriangle)) {
            return;
        }
        const Vector3f onAxis = m_capsule.from + t * m_axis;
        const float distance = (onA - onAxis).norm();
        const Vector3f& outer = m_mesh.vertexNormals[vertex];
        Vector3f normal = distance > 8 * m_rounding ? Vector3f((onA - onAxis) / distance) : Vector3f(-outer);
        // The rule is the same on both sides of the surface: the corner is locally closest to the axis.
        if (!detail::cornerIsExtremal(m_mesh, vertex, -normal, detail::cornerLean(m_mesh, vertex, m_settings.lean))) {
            return;
        }
        float height = distance;
        if (m_mesh.solid && normal.dot(outer) > 0) {
            normal = -normal;
            height = -distance;
        }
        add(key, onA, onAxis, normal, height, outer, triangle);
    }

    void edge(std::uint32_t triangle, unsigned edge) {
        const Triangle& corner = m_mesh.tree.triangles[triangle];
        const Vector3f& from = m_mesh.tree.vertices[corner[edge]];
        const Vector3f along = m_mesh.tree.vertices[corner[(edge + 1) % 3]] - from;
        const std::uint32_t other = m_mesh.topology.across[triangle][edge];
        if (other != noNeighbour &&
            (m_mesh.triangleNormals[triangle] - m_mesh.triangleNormals[other]).squaredNorm() < 4e-8F) {
            return;  // inside a flat face
        }
        const Vector3f cross = along.cross(m_axis);
        const float squaredArea = cross.squaredNorm();
        if (!(squaredArea > 1e-6F * along.squaredNorm() * m_squaredLength)) {
            return;  // parallel: the ends of both tell
        }
        const Vector3f offset = m_capsule.from - from;
        const float onEdge = offset.cross(m_axis).dot(cross) / squaredArea;
        const float onAxis = offset.cross(along).dot(cross) / squaredArea;
        const detail::FeaturePairKey key{detail::meshFeatureKey(m_mesh, triangle, static_cast<int>(edge) + 3), axisKey};
        if (!(onEdge > 0 && onEdge < 1 && onAxis > 0 && onAxis < 1) || !m_out.isNew(key, triangle, noTriangle)) {
            return;
        }
        const Vector3f onA = from + onEdge * along;
        const Vector3f center = m_capsule.from + onAxis * m_axis;
        Vector3f normal = cross / std::sqrt(squaredArea);
        const Vector3f outer = detail::pseudonormal(m_mesh, triangle, static_cast<int>(edge) + 3);
        if (m_mesh.solid ? normal.dot(outer) > 0 : normal.dot(onA - center) < 0) {
            normal = -normal;
        }
        const bool sharp = (m_mesh.traits[triangle] & (sharpEdge << edge)) != 0;
        const float height = (onA - center).dot(normal);
        const float lean =
            sharp ? m_settings.lean : std::min(0.1F, 1e-3F + m_rounding / (std::abs(height) + m_rounding));
        if (detail::edgeIsExtremal(m_mesh, triangle, edge, -normal, lean)) {
            add(key, onA, center, normal, height, outer.normalized(), triangle);
        }
    }

    /// `height`: of the mesh above the axis; negative if the axis is inside the mesh there, which is then verified.
    /// (The axis may run along other faces there, so the point is pulled inwards, against `outer`, by what rounding can
    /// take; by more, and an axis that passes close by outside would be taken for one that is deep inside.)
    void add(const detail::FeaturePairKey& key, const Vector3f& onA, const Vector3f& onAxis, const Vector3f& normal,
             float height, const Vector3f& outer, std::uint32_t triangle) {
        const float distance = height - m_capsule.radius;
        if (!(distance <= m_maxDistance)) {
            return;
        }
        const SurfaceContact contact{onA, onA - distance * normal, normal, distance, triangle, noTriangle};
        if (height >= -8 * m_rounding) {
            m_out.add(key, contact);
        } else if (m_mesh.solid && detail::isInside(m_mesh, onAxis + std::max(0.25F * height, -64 * m_rounding) * outer,
                                                    std::numeric_limits<float>::infinity())) {
            m_inside.emplace_back(key, contact);
        }
    }

    const MeshModel& m_mesh;
    CapsuleSolid m_capsule;
    float m_maxDistance;
    LocalContactSettings m_settings;
    detail::ContactCollector& m_out;
    std::vector<Inside>& m_inside;
    Vector3f m_axis;
    float m_squaredLength = 0;
    float m_rounding = 0;
};

}  // namespace

std::uint64_t capsuleContacts(const MeshModel& mesh, const CapsuleSolid& capsule, float maxDistance,
                              const LocalContactSettings& settings, std::vector<SurfaceContact>& out,
                              LeafChoice* choice) {
    const Vector3f axis = capsule.to - capsule.from;
    const float length = axis.norm();
    if (!(length > 0)) {
        return sphereContacts(mesh, {capsule.from, capsule.radius}, maxDistance, settings, out, choice);
    }
    detail::ConvexScratch& scratch = detail::convexScratch(choice);
    std::uint64_t work = 0;
    const Vector3f forwards = axis / length;
    const Vector3f backwards = -forwards;
    const detail::Ball ends[] = {{capsule.from, capsule.radius, {&forwards, 1}, detail::faceKey(0)},
                                 {capsule.to, capsule.radius, {&backwards, 1}, detail::faceKey(1)}};
    for (const detail::Ball& end : ends) {
        work += detail::pointContacts(mesh, end, maxDistance, settings, scratch.candidates, scratch.collector);
    }
    const float reach = capsule.radius + maxDistance;
    scratch.candidates.inBox(mesh, capsule.from.cwiseMin(capsule.to).array() - reach,
                             capsule.from.cwiseMax(capsule.to).array() + reach);
    thread_local std::vector<Inside> inside;
    inside.clear();
    AxisContacts between(mesh, capsule, maxDistance, settings, scratch.collector, inside);
    for (const std::uint32_t triangle : scratch.candidates.triangles()) {
        between.triangle(triangle);
    }
    between.finish();
    scratch.collector.finish(1e-4F * std::min(mesh.tree.radius, capsule.radius + length), out);
    return work + scratch.candidates.work();
}

}  // namespace grapeshot
