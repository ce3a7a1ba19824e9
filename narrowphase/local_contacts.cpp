// This work is based on:
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (Voronoi regions of features)
// Brian Mirtich. V-Clip: Fast and Robust Polyhedral Collision Detection. 1998 (penetrating features)
// Here for non-convex surfaces: local extrema instead of one closest pair, and a tolerance on the sharp features.
#include <grapeshot/narrowphase/local_contacts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/narrowphase/detail/contact_collector.hpp>
#include <grapeshot/narrowphase/detail/edge_contact.hpp>
#include <grapeshot/narrowphase/detail/extremum.hpp>
#include <grapeshot/narrowphase/detail/mesh_side.hpp>

namespace grapeshot {
namespace {

using detail::FeaturePairKey;
using detail::MeshSide;
using detail::PlacedTriangle;
using Eigen::Vector3f;

// Lean of features that are no face: they must be true extrema, or slanted contacts appear beside flat faces.
constexpr float exactLean = 1e-3F;
// Cosine of 0.005 rad: a direction this near to a face's normal takes it, so that flat contacts are exactly flat.
constexpr float snapCosine = 1 - 1.25e-5F;
// A corner is pulled this share of its depth into its own body before it is asked whether it is inside the other:
// corners often lie exactly on the other's side faces (stacked boxes), and boxes side by side do not overlap.
constexpr float pull = 0.25F;

// Cosine from which on faces count as parallel, so that one pair of witness points does not tell all.
constexpr float parallelFaces = 0.998F;

class LocalContactFinder {
  public:
    LocalContactFinder(const MeshModel& a, const MeshModel& b, const Pose& bInA, const LocalContactSettings& settings,
                       detail::ContactCollector& collector)
        : m_a(a, nullptr), m_b(b, &bInA), m_settings(settings), m_collector(collector) {
        const float extent = a.tree.radius + b.tree.radius + bInA.translation.norm();
        m_rounding = std::ldexp(extent, -22);
    }

    void pair(const TriangleContact& contact) {
        const auto [triangleA, triangleB] = contact.pair;
        const Vector3f normalB = m_b.directionToA(m_b.model().triangleNormals[triangleB]);
        const float facing = m_a.model().triangleNormals[triangleA].dot(normalB);
        // At every contact of two solids some triangles of both face each other.
        if (m_a.model().solid && m_b.model().solid && facing > m_settings.lean) {
            return;
        }
        if (triangleA != m_placedA.triangle) {
            m_a.place(triangleA, m_placedA);
        }
        if (triangleB != m_placedB.triangle) {
            m_b.place(triangleB, m_placedB);
        }
        const PlacedTriangle& a = m_placedA;
        const PlacedTriangle& b = m_placedB;
        cornersOnFace(m_a, a, m_b, b);
        cornersOnFace(m_b, b, m_a, a);
        if (contact.overlapping || std::abs(facing) > parallelFaces) {
            sharpEdges(a, b);  // otherwise the witness points have them
        }
        if (!contact.overlapping && contact.featureA < 6 && contact.featureB < 6) {
            witness(a, contact.featureA, b, contact.featureB);
        }
    }

  private:
    /// A corner of one side on a face of the other: what all the tests below talk about.
    struct CornerAndFace {
        const MeshSide& cornerSide;
        const PlacedTriangle& triangle;
        unsigned corner;
        std::uint32_t vertex;  // welded
        const MeshSide& faceSide;
        const PlacedTriangle& face;
        Vector3f outward;  // unit: from the face towards the corner's body
        float height;      // of the corner above the face, along `outward`
        [[nodiscard]] const Vector3f& point() const { return triangle.corner[corner]; }
    };

    void cornersOnFace(const MeshSide& cornerSide, const PlacedTriangle& triangle, const MeshSide& faceSide,
                       const PlacedTriangle& face) {
        if (face.normal.isZero()) {
            return;
        }
        Vector3f along[3];
        float climb[3];  // of each edge along the face's normal
        for (unsigned e = 0; e < 3; ++e) {
            along[e] = triangle.corner[(e + 1) % 3] - triangle.corner[e];
            climb[e] = along[e].dot(face.normal);
        }
        const float squaredLean = m_settings.lean * m_settings.lean;
        const auto rises = [&](unsigned e, float sign) {
            return sign * climb[e] >= 0 || climb[e] * climb[e] <= squaredLean * along[e].squaredNorm();
        };
        for (unsigned c = 0; c < 3; ++c) {
            if ((triangle.traits & (flatCorner << c)) != 0) {
                continue;
            }
            const float height = (triangle.corner[c] - face.corner[0]).dot(face.normal);
            float side = 1;
            if (!faceSide.model().solid) {  // a sheet's side is where the corner's body is
                side = cornerSide.model().solid
                           ? -cornerSide.vertexNormal(cornerSide.weldedCorner(triangle.triangle, c)).dot(face.normal)
                           : height;
                side = side < 0 ? -1.0F : 1.0F;
            }
            if (side * height <= m_settings.maxDistance && rises(c, side) && rises((c + 2) % 3, -side)) {
                cornerOnFace({cornerSide, triangle, c, cornerSide.weldedCorner(triangle.triangle, c), faceSide, face,
                              side * face.normal, side * height});
            }
        }
    }

    void cornerOnFace(const CornerAndFace& pair) {
        const bool behind = pair.height < 0;
        if (behind && !pair.cornerSide.model().solid && !pair.faceSide.model().solid) {
            return;
        }
        for (unsigned e = 0; e < 3; ++e) {
            const Vector3f& from = pair.face.corner[e];
            const Vector3f along = pair.face.corner[(e + 1) % 3] - from;
            const float off = -pair.face.normal.cross(along).dot(pair.point() - from);
            if (off > 0) {
                const float length = along.norm();
                const float tolerated = m_rounding + 1e-5F * length + exactLean * std::abs(pair.height);
                if (off > tolerated * length) {
                    if (behind) {
                        cornerBehindGap(pair, e);
                    }
                    return;
                }
            }
        }
        const FeaturePairKey key = keyOf(pair, detail::faceKey(pair.face.triangle));
        if (!isNew(key, pair.cornerSide, pair.triangle.triangle, pair.face.triangle) ||
            !cornerFaces(pair.cornerSide, pair.vertex, -pair.outward, m_settings.lean) ||
            (behind && !reallyBehind(pair))) {
            return;
        }
        add(key, pair.cornerSide, pair.point(), pair.point() - pair.height * pair.outward, pair.outward, pair.height,
            pair.triangle.triangle, pair.face.triangle);
    }

    /// The corner's surroundings lead away from `towards`, and its body lies on the other side.
    [[nodiscard]] bool cornerFaces(const MeshSide& side, std::uint32_t vertex, const Vector3f& towards,
                                   float lean) const {
        const Vector3f local = side.directionFromA(towards);
        const MeshModel& model = side.model();
        const Vector3f& normal = model.vertexNormals[vertex];
        return (!model.solid || normal.isZero() || normal.dot(local) > 0) &&
               detail::cornerIsExtremal(model, vertex, local, lean);
    }

    /// Is a corner below the plane of a face inside the face's solid, with nothing between it and the face? For a
    /// sheet: is the place on the sheet inside the corner's solid?
    [[nodiscard]] bool reallyBehind(const CornerAndFace& pair) const {
        const float depth = -pair.height;
        if (depth < 8 * m_rounding) {
            return true;  // below what the tests below can tell; the bodies touch
        }
        const Vector3f onFace = pair.point() + depth * pair.outward;
        if (!pair.faceSide.model().solid) {
            return insideOwnBody(pair, onFace);
        }
        Vector3f from = pair.point();
        if (pair.cornerSide.model().solid) {
            from -= pull * depth * pair.cornerSide.vertexNormal(pair.vertex);
        }
        const Vector3f middle = (pair.face.corner[0] + pair.face.corner[1] + pair.face.corner[2]) / 3;
        const Vector3f target = onFace + 1e-3F * (middle - onFace);
        const auto hit = castRay(pair.faceSide.model().tree, pair.faceSide.pointFromA(from),
                                 pair.faceSide.directionFromA(target - from), 1.05F);
        return hit && hit->backFace && hit->t > 0.9F;
    }

    [[nodiscard]] bool insideOwnBody(const CornerAndFace& pair, const Vector3f& point) const {
        const Vector3f pulled = point + pull * pair.height * pair.cornerSide.vertexNormal(pair.vertex);
        return detail::isInside(pair.cornerSide.model(), pair.cornerSide.pointFromA(pulled),
                                std::numeric_limits<float>::infinity());
    }

    /// A corner below a face but beside it, over edge `edge`: below a valley it is under neither face, and the way out
    /// is to the valley's line.
    void cornerBehindGap(const CornerAndFace& pair, unsigned edge) {
        const std::uint32_t neighbour = pair.faceSide.model().topology.across[pair.face.triangle][edge];
        if (neighbour == noNeighbour ||
            (pair.faceSide.model().solid && (pair.face.traits & (concaveEdge << edge)) == 0)) {
            return;
        }
        // The way to the line must lie between the normals of the two faces, and be one the corner can go.
        const Vector3f& from = pair.face.corner[edge];
        const Vector3f along = pair.face.corner[(edge + 1) % 3] - from;
        const float t = std::clamp((pair.point() - from).dot(along) / along.squaredNorm(), 0.0F, 1.0F);
        const Vector3f way = from + t * along - pair.point();
        const float length = way.norm();
        const Vector3f& across = pair.faceSide.model().triangleNormals[neighbour];
        const float turn = pair.face.normal.dot(pair.faceSide.directionToA(across));
        if (length < 8 * m_rounding || way.dot(pair.outward) < (turn - 1e-3F) * length ||
            !cornerFaces(pair.cornerSide, pair.vertex, -way / length, m_settings.lean)) {
            return;
        }
        const MeshModel& faceModel = pair.faceSide.model();
        const Vector3f local = pair.faceSide.pointFromA(pair.point());
        const auto closest = closestPoint(faceModel.tree, local, 1.01F * length);
        if (!closest || closest->feature == 6 || closest->distance < 8 * m_rounding) {
            return;  // (under a face: found with that face)
        }
        const Vector3f outer = detail::pseudonormal(faceModel, closest->triangle, closest->feature);
        const Vector3f onFace = pair.faceSide.pointToA(closest->point);
        if (faceModel.solid ? (local - closest->point).dot(outer) >= 0 : !insideOwnBody(pair, onFace)) {
            return;
        }
        const FeaturePairKey key = keyOf(pair, featureKey(pair.faceSide, closest->triangle, closest->feature));
        const Vector3f outward = (onFace - pair.point()) / closest->distance;
        if (isNew(key, pair.cornerSide, pair.triangle.triangle, closest->triangle) &&
            cornerFaces(pair.cornerSide, pair.vertex, -outward, m_settings.lean)) {
            add(key, pair.cornerSide, pair.point(), onFace, outward, -closest->distance, pair.triangle.triangle,
                closest->triangle);
        }
    }

    /// Crossings of sharp edges: the corners of where nearly parallel faces overlap, and edges cut into each other.
    void sharpEdges(const PlacedTriangle& a, const PlacedTriangle& b) {
        if ((a.traits & 7U) == 0 || (b.traits & 7U) == 0) {
            return;
        }
        for (unsigned edgeA = 0; edgeA < 3; ++edgeA) {
            if ((a.traits & (sharpEdge << edgeA)) == 0) {
                continue;
            }
            const detail::SurfaceEdge onA = m_a.edge(a, edgeA);
            for (unsigned edgeB = 0; edgeB < 3; ++edgeB) {
                if ((b.traits & (sharpEdge << edgeB)) != 0) {
                    edges(onA, a, edgeA, m_b.edge(b, edgeB), b, edgeB);
                }
            }
        }
    }

    void edges(const detail::SurfaceEdge& onA, const PlacedTriangle& a, unsigned edgeA, const detail::SurfaceEdge& onB,
               const PlacedTriangle& b, unsigned edgeB) {
        const FeaturePairKey key{featureKey(m_a, a.triangle, static_cast<int>(edgeA) + 3),
                                 featureKey(m_b, b.triangle, static_cast<int>(edgeB) + 3)};
        const std::uint32_t triangleA = m_a.firstTriangle(a.triangle, edgeA);
        const std::uint32_t triangleB = m_b.firstTriangle(b.triangle, edgeB);
        if (!m_collector.isNew(key, triangleA, triangleB)) {
            return;
        }
        const detail::EdgeContacts found = detail::edgeContacts(onA, onB, m_settings.lean, m_rounding);
        for (int i = 0; i < found.count; ++i) {
            SurfaceContact contact = found.contact[i];
            contact.triangleA = triangleA;
            contact.triangleB = triangleB;
            if (contact.signedDistance <= m_settings.maxDistance &&
                (contact.signedDistance >= 0 || reallyCrossed(onA, onB, contact))) {
                m_collector.add(key, contact);
            }
        }
    }

    /// Edges have passed each other: is each, pulled into both bodies, really inside the other's?
    [[nodiscard]] bool reallyCrossed(const detail::SurfaceEdge& onA, const detail::SurfaceEdge& onB,
                                     const SurfaceContact& contact) const {
        const float depth = -contact.signedDistance;
        if (depth < 8 * m_rounding) {
            return true;
        }
        const Vector3f inwards = (onA.own + onA.across).normalized() + (onB.own + onB.across).normalized();
        const Vector3f shift = -pull * depth * inwards;
        constexpr float anyDistance = std::numeric_limits<float>::infinity();
        return detail::isInside(m_a.model(), contact.onB + shift, anyDistance) &&
               detail::isInside(m_b.model(), m_b.pointFromA(contact.onA + shift), anyDistance);
    }

    /// The closest features of a pair of triangles, neither of them a face.
    void witness(const PlacedTriangle& a, int featureA, const PlacedTriangle& b, int featureB) {
        const auto indexA = static_cast<unsigned>(featureA % 3);
        const auto indexB = static_cast<unsigned>(featureB % 3);
        if (featureA >= 3 && featureB >= 3) {
            const detail::SurfaceEdge onA = m_a.edge(a, indexA);
            const detail::SurfaceEdge onB = m_b.edge(b, indexB);
            if (!onA.flat() && !onB.flat()) {
                edges(onA, a, indexA, onB, b, indexB);
            }
        } else if (featureA < 3) {
            cornerOnRim(m_a, a, indexA, m_b, b, featureB);
        } else {
            cornerOnRim(m_b, b, indexB, m_a, a, featureA);
        }
    }

    /// A corner beyond an edge or before a corner of the other side.
    void cornerOnRim(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                     const MeshSide& rimSide, const PlacedTriangle& rim, int feature) {
        const std::uint32_t vertex = cornerSide.weldedCorner(triangle.triangle, corner);
        const std::uint64_t cornerKey = detail::cornerKey(vertex);
        const std::uint64_t rimKey = featureKey(rimSide, rim.triangle, feature);
        const FeaturePairKey key =
            cornerSide.isA() ? FeaturePairKey{cornerKey, rimKey} : FeaturePairKey{rimKey, cornerKey};
        if (!isNew(key, cornerSide, triangle.triangle, rim.triangle)) {
            return;
        }
        const auto index = static_cast<unsigned>(feature % 3);
        const Vector3f& point = triangle.corner[corner];
        Vector3f onRim = rim.corner[index];
        if (feature >= 3) {
            const detail::SurfaceEdge edge = rimSide.edge(rim, index);
            const Vector3f along = edge.to - edge.from;
            onRim = edge.from + std::clamp((point - edge.from).dot(along) / along.squaredNorm(), 0.0F, 1.0F) * along;
        }
        const Vector3f rimNormal =
            rimSide.directionToA(detail::pseudonormal(rimSide.model(), rim.triangle, feature)).normalized();
        float distance = (point - onRim).norm();
        Vector3f outward = (point - onRim) / distance;
        if (distance < 8 * m_rounding) {  // no direction of its own
            outward = rimNormal - cornerSide.vertexNormal(vertex);
            const float length = outward.norm();
            if (!(length > 0.1F) || !(rimSide.model().solid || cornerSide.model().solid)) {
                return;
            }
            outward /= length;
        }
        const float lean = std::min(0.1F, exactLean + m_rounding / (distance + m_rounding));
        const Vector3f towardsCorner = rimSide.directionFromA(outward);
        if ((rimSide.model().solid && rimNormal.dot(outward) <= 0) ||
            !cornerFaces(cornerSide, vertex, -outward, lean) ||
            !(feature >= 3 ? detail::edgeIsExtremal(rimSide.model(), rim.triangle, index, towardsCorner, lean)
                           : detail::cornerIsExtremal(rimSide.model(), rimSide.weldedCorner(rim.triangle, index),
                                                      towardsCorner, lean))) {
            return;
        }
        if (feature >= 3) {
            outward = snapped(rimSide, rim, index, outward);
        }
        distance = (point - onRim).dot(outward);
        if (distance <= m_settings.maxDistance) {
            add(key, cornerSide, point, point - distance * outward, outward, distance, triangle.triangle, rim.triangle);
        }
    }

    /// The normal of one of the edge's faces if it is nearly that.
    [[nodiscard]] static Vector3f snapped(const MeshSide& side, const PlacedTriangle& triangle, unsigned edge,
                                          const Vector3f& direction) {
        const detail::SurfaceEdge faces = side.edge(triangle, edge);
        for (const Vector3f* normal : {&faces.own, &faces.across}) {
            const float cosine = normal->dot(direction);
            if (std::abs(cosine) > snapCosine) {
                return cosine > 0 ? *normal : Vector3f(-*normal);
            }
        }
        return direction;
    }

    [[nodiscard]] static std::uint64_t featureKey(const MeshSide& side, std::uint32_t triangle, int feature) {
        const auto index = static_cast<unsigned>(feature % 3);
        const std::uint32_t vertex = side.weldedCorner(triangle, index);
        return feature < 3   ? detail::cornerKey(vertex)
               : feature < 6 ? detail::edgeKey(vertex, side.weldedCorner(triangle, (index + 1) % 3))
                             : detail::faceKey(triangle);
    }
    [[nodiscard]] static FeaturePairKey keyOf(const CornerAndFace& pair, std::uint64_t other) {
        const std::uint64_t corner = detail::cornerKey(pair.vertex);
        return pair.cornerSide.isA() ? FeaturePairKey{corner, other} : FeaturePairKey{other, corner};
    }
    bool isNew(const FeaturePairKey& key, const MeshSide& cornerSide, std::uint32_t cornerTriangle,
               std::uint32_t otherTriangle) {
        return cornerSide.isA() ? m_collector.isNew(key, cornerTriangle, otherTriangle)
                                : m_collector.isNew(key, otherTriangle, cornerTriangle);
    }
    /// `outward`: from the other side towards the corner's body.
    void add(const FeaturePairKey& key, const MeshSide& cornerSide, const Vector3f& corner, const Vector3f& other,
             const Vector3f& outward, float distance, std::uint32_t cornerTriangle, std::uint32_t otherTriangle) {
        if (cornerSide.isA()) {
            m_collector.add(key, {corner, other, outward, distance, cornerTriangle, otherTriangle});
        } else {
            m_collector.add(key, {other, corner, -outward, distance, otherTriangle, cornerTriangle});
        }
    }

    MeshSide m_a, m_b;
    LocalContactSettings m_settings;
    detail::ContactCollector& m_collector;
    float m_rounding = 0;  // of coordinates in A's frame, m
    PlacedTriangle m_placedA, m_placedB;
};

}  // namespace

void localContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, std::span<const TriangleContact> pairs,
                   const LocalContactSettings& settings, std::vector<SurfaceContact>& out) {
    thread_local detail::ContactCollector collector;
    collector.clear();
    LocalContactFinder finder(a, b, bInA, settings, collector);
    for (const TriangleContact& pair : pairs) {
        finder.pair(pair);
    }
    collector.thinCorners();
    collector.finish(1e-4F * std::min(a.tree.radius, b.tree.radius), out);
}

}  // namespace grapeshot
