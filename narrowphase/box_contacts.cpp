#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/narrowphase/detail/box_cut.hpp>
#include <grapeshot/narrowphase/detail/edge_contact.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3f;

/// A mesh vertex inside the box.
struct Inside {
    Vector3f inBox;  // box frame, m
    std::uint32_t vertex = 0;
    std::uint32_t triangle = 0;
    bool flat = false;           // only measures how deep the mesh is
    std::array<bool, 6> ways{};  // faces through which it could leave
};

constexpr unsigned none = 6;

// Faces are numbered 2 * axis + (1 if on the negative side).
Vector3f faceNormal(unsigned face) {
    return Vector3f::Unit(face / 2) * (face % 2 == 0 ? 1.0F : -1.0F);
}

class BoxContactFinder {
  public:
    BoxContactFinder(const MeshModel& mesh, const BoxSolid& box, float maxDistance,
                     const LocalContactSettings& settings, detail::ConvexScratch& scratch, std::vector<Inside>& inside)
        : m_mesh(mesh),
          m_box(box),
          m_maxDistance(maxDistance),
          m_settings(settings),
          m_scratch(scratch),
          m_inside(inside) {
        m_rounding = detail::coordinateRounding(mesh.tree.radius + box.pose.translation.norm() + box.half.norm());
        m_extent = box.pose.rotation.transpose().cwiseAbs() * (mesh.tree.upper - mesh.tree.lower);
        for (unsigned c = 0; c < 8; ++c) {
            const Vector3f signs((c & 1U) != 0 ? 1.0F : -1.0F, (c & 2U) != 0 ? 1.0F : -1.0F,
                                 (c & 4U) != 0 ? 1.0F : -1.0F);
            m_corner[c] = apply(box.pose, box.half.cwiseProduct(signs));
        }
    }

    std::uint64_t run() {
        meshCorners();
        if (bodiesNearEdges()) {
            boxCorners();
            boxEdges();
        }
        return m_work;
    }

    /// What `run` looks at.
    std::uint64_t regions(std::vector<SearchRegion>& out) const {
        out.push_back(nearestHalf());
        if (!bodiesNearEdges()) {
            return 0;
        }
        for (unsigned from = 0; from < 8; ++from) {
            out.push_back(around(from, from));
            for (unsigned axis = 0; axis < 3; ++axis) {
                if ((from & (1U << axis)) == 0) {
                    out.push_back(around(from, from | (1U << axis)));
                }
            }
        }
        return m_mesh.solid ? 8 : 0;
    }

  private:
    detail::ContactCollector& found() { return m_scratch.collector; }

    // Mesh corners against the box's faces, edges and corners.

    /// Below the face beyond which most of the mesh is: it leaves the fewest candidates.
    [[nodiscard]] SearchRegion nearestHalf() const {
        const Vector3f middle = (m_mesh.tree.lower + m_mesh.tree.upper) / 2;
        const Vector3f inBox = m_box.pose.rotation.transpose() * (middle - m_box.pose.translation);
        unsigned best = 0;
        float farthest = -std::numeric_limits<float>::infinity();
        for (unsigned face = 0; face < 6; ++face) {
            const float height = faceNormal(face).dot(inBox) - m_box.half[face / 2];
            if (height > farthest) {
                farthest = height;
                best = face;
            }
        }
        const Vector3f normal = m_box.pose.rotation * faceNormal(best);
        return SearchRegion::belowPlane(normal,
                                        normal.dot(m_box.pose.translation) + m_box.half[best / 2] + m_maxDistance);
    }

    /// The edge between two corners and what is within reach of it.
    [[nodiscard]] SearchRegion around(unsigned from, unsigned to) const {
        return SearchRegion::inBox(m_corner[from].cwiseMin(m_corner[to]).array() - m_maxDistance,
                                   m_corner[from].cwiseMax(m_corner[to]).array() + m_maxDistance);
    }

    void meshCorners() {
        const SearchRegion half = nearestHalf();
        m_scratch.candidates.belowPlane(m_mesh, half.normal, half.offset);
        m_work += m_scratch.candidates.work();
        m_inside.clear();
        const Vector3f limit = m_box.half.array() + m_maxDistance;
        for (const std::uint32_t triangle : m_scratch.candidates.triangles()) {
            for (unsigned c = 0; c < 3; ++c) {
                const std::uint32_t vertex = m_mesh.topology.welded[m_mesh.tree.triangles[triangle][c]];
                const Vector3f x =
                    m_box.pose.rotation.transpose() * (m_mesh.tree.vertices[vertex] - m_box.pose.translation);
                if ((x.cwiseAbs().array() > limit.array()).any() ||
                    !found().isNew({detail::cornerKey(vertex), ~std::uint64_t{0}}, triangle, noTriangle)) {
                    continue;
                }
                const bool flat = (m_mesh.traits[triangle] & (flatCorner << c)) != 0;
                if ((x.cwiseAbs().array() <= m_box.half.array()).all()) {
                    m_inside.push_back({x, vertex, triangle, flat});
                } else if (!flat) {
                    cornerOutside(x, vertex, triangle);
                }
            }
        }
        cornersInside();
    }

    void cornerOutside(const Vector3f& x, std::uint32_t vertex, std::uint32_t triangle) {
        Vector3f excess = (x.cwiseAbs() - m_box.half).cwiseMax(0.0F);
        // Beside a face by no more than rounding is over the face.
        const float tolerated = m_rounding + 1e-3F * excess.maxCoeff();
        int beyond = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (excess[axis] <= tolerated && excess[axis] < excess.maxCoeff()) {
                excess[axis] = 0;
            }
            beyond += excess[axis] > 0 ? 1 : 0;
            excess[axis] = std::copysign(excess[axis], x[axis]);
        }
        const float distance = excess.norm();
        const Vector3f normal = m_box.pose.rotation * (excess / distance);
        const float lean = beyond == 1 ? detail::cornerLean(m_mesh, vertex, m_settings.lean)
                                       : std::min(0.1F, 1e-3F + m_rounding / distance);
        // One feature of the box has one key: a digit per axis.
        std::uint32_t feature = 0;
        for (int axis = 0; axis < 3; ++axis) {
            feature = 3 * feature + (excess[axis] > 0 ? 1U : excess[axis] < 0 ? 2U : 0U);
        }
        if (distance <= m_maxDistance && cornerFaces(vertex, normal, lean)) {
            add({detail::cornerKey(vertex), detail::faceKey(feature)}, m_mesh.tree.vertices[vertex], normal, distance,
                triangle);
        }
    }

    /// `normal`: on the box pointing to the mesh.
    [[nodiscard]] bool cornerFaces(std::uint32_t vertex, const Vector3f& normal, float lean) const {
        return (!m_mesh.solid || m_mesh.vertexNormals[vertex].dot(normal) <= 0) &&
               detail::cornerIsExtremal(m_mesh, vertex, -normal, lean);
    }

    /// Which way out? The corner must be an extremum that way. The face through which all that is inside comes out
    /// soonest has the say; another one only where it is nearer (a U around a bar).
    void cornersInside() {
        std::array<float, 6> toLeave{};
        std::array<bool, 6> possible{};
        const bool through = !m_inside.empty() && detail::canReachThrough(m_mesh, m_box);
        for (Inside& corner : m_inside) {
            for (unsigned face = 0; face < 6; ++face) {
                toLeave[face] = std::max(toLeave[face], depth(corner, face));
                // Out of a thin wall nobody goes along it, by more than his own length.
                corner.ways[face] = !corner.flat && (!through || depth(corner, face) <= m_extent[face / 2]) &&
                                    cornerFaces(corner.vertex, m_box.pose.rotation * faceNormal(face),
                                                detail::cornerLean(m_mesh, corner.vertex, m_settings.lean));
                possible[face] = possible[face] || corner.ways[face];
            }
        }
        unsigned common = none;
        for (unsigned face = 0; face < 6; ++face) {
            if (possible[face] && (common == none || toLeave[face] < toLeave[common])) {
                common = face;
            }
        }
        for (const Inside& corner : m_inside) {
            unsigned chosen = none;
            for (unsigned face = 0; face < 6; ++face) {
                if (corner.ways[face] && (face == common || depth(corner, face) < depth(corner, common)) &&
                    (chosen == none || depth(corner, face) < depth(corner, chosen))) {
                    chosen = face;
                }
            }
            if (chosen != none) {
                add({detail::cornerKey(corner.vertex), detail::faceKey(27 + chosen)},
                    m_mesh.tree.vertices[corner.vertex], m_box.pose.rotation * faceNormal(chosen),
                    -depth(corner, chosen), corner.triangle);
            }
        }
    }

    [[nodiscard]] float depth(const Inside& corner, unsigned face) const {
        return m_box.half[face / 2] - faceNormal(face).dot(corner.inBox);
    }

    // The box's corners and edges against the mesh; rare for a floor.

    /// Does the mesh's box come near to more than one face's interior?
    [[nodiscard]] bool bodiesNearEdges() const {
        const Vector3f middle = (m_mesh.tree.lower + m_mesh.tree.upper) / 2;
        const Vector3f half = (m_mesh.tree.upper - m_mesh.tree.lower) / 2;
        const Vector3f inBox = m_box.pose.rotation.transpose() * (middle - m_box.pose.translation);
        const Vector3f reach = m_box.pose.rotation.transpose().cwiseAbs() * half;
        int crossed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float outermost = std::abs(inBox[axis]) + reach[axis];
            crossed += outermost + m_maxDistance >= m_box.half[axis] ? 1 : 0;
        }
        return crossed >= 2;
    }

    void boxCorners() {
        for (unsigned c = 0; c < 8; ++c) {
            std::array<Vector3f, 3> edges;
            for (unsigned axis = 0; axis < 3; ++axis) {
                const float sign = (c & (1U << axis)) != 0 ? -1.0F : 1.0F;
                edges[axis] = sign * m_box.pose.rotation.col(axis);
            }
            const detail::Ball ball{m_corner[c], 0, edges, detail::cornerKey(c)};
            m_work += detail::pointContacts(m_mesh, ball, m_maxDistance, m_settings, m_scratch.candidates, found());
        }
    }

    void boxEdges() {
        for (unsigned c = 0; c < 8; ++c) {
            for (unsigned axis = 0; axis < 3; ++axis) {
                if ((c & (1U << axis)) == 0) {
                    boxEdge(c, c | (1U << axis), axis);
                }
            }
        }
    }

    void boxEdge(unsigned from, unsigned to, unsigned axis) {
        const SearchRegion near = around(from, to);
        if ((near.lower.array() > m_mesh.tree.upper.array()).any() ||
            (near.upper.array() < m_mesh.tree.lower.array()).any()) {
            return;
        }
        detail::SurfaceEdge onBox;
        onBox.from = m_corner[from];
        onBox.to = m_corner[to];
        onBox.sharp = true;
        onBox.solid = true;
        const unsigned next = (axis + 1) % 3;
        const unsigned last = (axis + 2) % 3;
        const auto normal = [&](unsigned i) {
            return Vector3f(m_box.pose.rotation.col(i) * ((from & (1U << i)) != 0 ? 1.0F : -1.0F));
        };
        // The face left of the edge, seen from outside, is the one whose normal x along leads into it.
        const bool nextIsLeft = normal(next).cross(m_corner[to] - m_corner[from]).dot(normal(last)) < 0;
        onBox.own = normal(nextIsLeft ? next : last);
        onBox.across = normal(nextIsLeft ? last : next);
        m_scratch.candidates.inBox(m_mesh, near.lower, near.upper);
        m_work += m_scratch.candidates.work();
        for (const std::uint32_t triangle : m_scratch.candidates.triangles()) {
            for (unsigned edge = 0; edge < 3; ++edge) {
                if ((m_mesh.traits[triangle] & (concaveEdge << edge)) == 0) {
                    edges(triangle, edge, onBox, detail::edgeKey(from, to));
                }
            }
        }
    }

    void edges(std::uint32_t triangle, unsigned edge, const detail::SurfaceEdge& onBox, std::uint64_t boxKey) {
        const detail::FeaturePairKey key{detail::meshFeatureKey(m_mesh, triangle, static_cast<int>(edge) + 3), boxKey};
        const std::uint32_t other = m_mesh.topology.across[triangle][edge];
        if (!found().isNew(key, std::min(triangle, other), noTriangle)) {
            return;
        }
        const Triangle& corner = m_mesh.tree.triangles[triangle];
        detail::SurfaceEdge onMesh;
        onMesh.from = m_mesh.tree.vertices[corner[edge]];
        onMesh.to = m_mesh.tree.vertices[corner[(edge + 1) % 3]];
        onMesh.own = m_mesh.triangleNormals[triangle];
        onMesh.across = other == noNeighbour ? Vector3f(Vector3f::Zero()) : m_mesh.triangleNormals[other];
        onMesh.sharp = (m_mesh.traits[triangle] & (sharpEdge << edge)) != 0;
        onMesh.solid = m_mesh.solid;
        if (onMesh.flat()) {
            return;
        }
        const detail::EdgeContacts contacts = detail::edgeContacts(onMesh, onBox, m_settings.lean, m_rounding);
        for (int i = 0; i < contacts.count; ++i) {
            SurfaceContact contact = contacts.contact[i];
            contact.triangleA = std::min(triangle, other);
            if (contact.signedDistance <= m_maxDistance &&
                (contact.signedDistance >= -8 * m_rounding || reallyCrossed(onMesh, onBox, contact))) {
                found().add(key, contact);
            }
        }
    }

    [[nodiscard]] bool reallyCrossed(const detail::SurfaceEdge& onMesh, const detail::SurfaceEdge& onBox,
                                     const SurfaceContact& contact) const {
        const Vector3f inwards = (onMesh.own + onMesh.across).normalized() + (onBox.own + onBox.across).normalized();
        const Vector3f shift = 0.25F * contact.signedDistance * inwards;
        const Vector3f inBox = m_box.pose.rotation.transpose() * (contact.onA + shift - m_box.pose.translation);
        return (inBox.cwiseAbs().array() < m_box.half.array()).all() &&
               detail::isInside(m_mesh, contact.onB + shift, std::numeric_limits<float>::infinity());
    }

    void add(const detail::FeaturePairKey& key, const Vector3f& onA, const Vector3f& normal, float distance,
             std::uint32_t triangle) {
        if (found().isNew(key, triangle, noTriangle)) {
            found().add(key, {onA, onA - distance * normal, normal, distance, triangle, noTriangle});
        }
    }

    const MeshModel& m_mesh;
    BoxSolid m_box;
    float m_maxDistance;
    LocalContactSettings m_settings;
    detail::ConvexScratch& m_scratch;
    std::vector<Inside>& m_inside;
    std::array<Vector3f, 8> m_corner;  // mesh frame
    Vector3f m_extent;                 // of the mesh along the box's axes, m
    float m_rounding = 0;
    std::uint64_t m_work = 0;
};

}  // namespace

std::uint64_t detail::boxRegions(const MeshModel& mesh, const BoxSolid& box, float maxDistance,
                                 std::vector<SearchRegion>& out) {
    std::vector<Inside> inside;
    return BoxContactFinder(mesh, box, maxDistance, {}, convexScratch(nullptr), inside).regions(out);
}

std::uint64_t boxContacts(const MeshModel& mesh, const BoxSolid& box, float maxDistance,
                          const LocalContactSettings& settings, std::vector<SurfaceContact>& out, LeafChoice* choice) {
    thread_local std::vector<Inside> inside;
    detail::ConvexScratch& scratch = detail::convexScratch(choice);
    const std::size_t first = out.size();
    std::uint64_t work = BoxContactFinder(mesh, box, maxDistance, settings, scratch, inside).run();
    scratch.collector.thinCorners();
    scratch.collector.finish(1e-4F * std::min(mesh.tree.radius, box.half.norm()), out);
    if (out.size() == first && (choice == nullptr || choice->all)) {
        work += detail::boxCutContacts(mesh, box, out, choice);
    }
    return work;
}

}  // namespace grapeshot
