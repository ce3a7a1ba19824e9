#include <grapeshot/narrowphase/detail/feature_contacts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/core/triangle_batch.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;

// Lean of features that are no face: they must be true extrema, or slanted contacts appear beside flat faces.
constexpr float exactLean = 1e-3F;
// Cosine of 0.005 rad: a direction this near to a face's normal takes it, so that flat contacts are exactly flat.
constexpr float snapCosine = 1 - 1.25e-5F;
// A corner is pulled this share of its depth into its own body before it is asked whether it is inside the other:
// corners often lie exactly on the other's side faces (stacked boxes), and boxes side by side do not overlap.
constexpr float pull = 0.25F;

/// The normal of one of the edge's faces if it is nearly that.
Vector3f snapped(const SurfaceEdge& edge, const Vector3f& direction) {
    for (const Vector3f* normal : {&edge.own, &edge.across}) {
        const float cosine = normal->dot(direction);
        if (std::abs(cosine) > snapCosine) {
            return cosine > 0 ? *normal : Vector3f(-*normal);
        }
    }
    return direction;
}

}  // namespace

/// A corner of one side on a face of the other.
struct FeatureContacts::CornerAndFace {
    const MeshSide& cornerSide;
    const PlacedTriangle& triangle;
    Vector3f point;
    std::uint32_t vertex;  // welded
    const MeshSide& faceSide;
    const PlacedTriangle& face;
    Vector3f outward;  // unit: from the face towards the corner's body
    float height;      // of the corner above the face, along `outward`
    float lean;        // allowed to the corner
};

void FeatureContacts::everything(const PlacedTriangle& a, const PlacedTriangle& b) {
    for (unsigned i = 0; i < 3; ++i) {
        cornerBFaceA(a, b, i);
        cornerAFaceB(a, i, b);
        for (unsigned j = 0; j < 3; ++j) {
            edges(a, i, b, j);
            cornerBEdgeA(a, i, b, j);
            cornerAEdgeB(a, i, b, j);
            corners(a, i, b, j);
        }
    }
}

void FeatureContacts::cornerAndFace(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                                    const MeshSide& faceSide, const PlacedTriangle& face) {
    if (face.normal.isZero() || (triangle.traits & (flatCorner << corner)) != 0) {
        return;
    }
    const Vector3f& point = triangle.corner[corner];
    const float height = (point - face.corner[0]).dot(face.normal);
    const std::uint32_t vertex = cornerSide.weldedCorner(triangle.triangle, corner);
    float side = 1;
    if (!faceSide.model().solid) {  // a sheet's side is where the corner's body is
        side = cornerSide.model().solid ? -cornerSide.vertexNormal(vertex).dot(face.normal) : height;
        side = side < 0 ? -1.0F : 1.0F;
    }
    if (!(side * height <= m_settings.maxDistance)) {
        return;
    }
    const float lean = cornerLean(cornerSide.model(), vertex, m_settings.lean);
    const auto rises = [&](unsigned other) {
        const Vector3f along = triangle.corner[other] - point;
        const float climb = side * along.dot(face.normal);
        return climb >= 0 || climb * climb <= lean * lean * along.squaredNorm();
    };
    if (rises((corner + 1) % 3) && rises((corner + 2) % 3)) {
        cornerOnFace({cornerSide, triangle, point, vertex, faceSide, face, side * face.normal, side * height, lean});
    }
}

void FeatureContacts::cornerOnFace(const CornerAndFace& pair) {
    const bool behind = pair.height < 0;
    if (behind && !pair.cornerSide.model().solid && !pair.faceSide.model().solid) {
        return;
    }
    for (unsigned e = 0; e < 3; ++e) {
        const Vector3f& from = pair.face.corner[e];
        const Vector3f along = pair.face.corner[(e + 1) % 3] - from;
        const float off = -pair.face.normal.cross(along).dot(pair.point - from);
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
    const std::uint64_t face = faceKey(pair.face.triangle);
    if (counts(pair.triangle, pair.face, pair.height) && isNew(pair.cornerSide, pair.vertex, face) &&
        cornerFaces(pair.cornerSide, pair.vertex, -pair.outward, pair.lean) && (!behind || reallyBehind(pair))) {
        add(pair.cornerSide, pair.vertex, face,
            {pair.point, pair.point - pair.height * pair.outward, pair.outward, pair.height, noTriangle,
             pair.face.triangle});
    }
}

/// Deeper than maxDistance only what triangles say that cut each other: what else lies so deep is found or not by the
/// chance of what is near it, and left to penetration.hpp.
bool FeatureContacts::counts(const PlacedTriangle& a, const PlacedTriangle& b, float signedDistance) const {
    if (signedDistance >= -m_settings.maxDistance) {
        return true;
    }
    TriangleBatch batchA;
    TriangleBatch batchB;
    for (unsigned lane = 0; lane < batchWidth; ++lane) {
        for (unsigned c = 0; c < 3; ++c) {
            for (unsigned axis = 0; axis < 3; ++axis) {
                batchA.corner[c][axis][lane] = a.corner[c][static_cast<int>(axis)];
                batchB.corner[c][axis][lane] = b.corner[c][static_cast<int>(axis)];
            }
        }
    }
    return (overlaps(batchA, batchB) & 1U) != 0;
}

/// The corner's surroundings lead away from `towards`, and its body lies on the other side.
bool FeatureContacts::cornerFaces(const MeshSide& side, std::uint32_t vertex, const Vector3f& towards,
                                  float lean) const {
    const Vector3f local = side.directionFromA(towards);
    const MeshModel& model = side.model();
    const Vector3f& normal = model.vertexNormals[vertex];
    const float upward = model.solid ? normal.dot(local) : std::abs(normal.dot(local));
    return (!model.solid || normal.isZero() || upward > 0) &&
           upward >= widenedCone(model.vertexCones[vertex], m_cosLean, m_sinLean) &&
           cornerIsExtremal(model, vertex, local, lean);
}

/// Is a corner below the plane of a face inside the face's solid, with nothing between it and the face? For a sheet: is
/// the place on the sheet inside the corner's solid?
bool FeatureContacts::reallyBehind(const CornerAndFace& pair) const {
    const float depth = -pair.height;
    if (depth < 8 * m_rounding) {
        return true;  // below what the tests below can tell; the bodies touch
    }
    const Vector3f onFace = pair.point + depth * pair.outward;
    if (!pair.faceSide.model().solid) {
        return insideOwnBody(pair, onFace);
    }
    Vector3f from = pair.point;
    if (pair.cornerSide.model().solid) {
        from -= pull * depth * pair.cornerSide.vertexNormal(pair.vertex);
    }
    const Vector3f middle = (pair.face.corner[0] + pair.face.corner[1] + pair.face.corner[2]) / 3;
    const Vector3f target = onFace + 1e-3F * (middle - onFace);
    const auto hit = castRay(pair.faceSide.model().tree, pair.faceSide.pointFromA(from),
                             pair.faceSide.directionFromA(target - from), 1.05F);
    return hit && hit->backFace && hit->t > 0.9F;
}

bool FeatureContacts::insideOwnBody(const CornerAndFace& pair, const Vector3f& point) const {
    const Vector3f pulled = point + pull * pair.height * pair.cornerSide.vertexNormal(pair.vertex);
    return isInside(pair.cornerSide.model(), pair.cornerSide.pointFromA(pulled),
                    std::numeric_limits<float>::infinity());
}

/// A corner below a face but beside it, over edge `edge`: below a valley it is under neither face, and the way out is
/// to the valley's line.
void FeatureContacts::cornerBehindGap(const CornerAndFace& pair, unsigned edge) {
    const MeshModel& faceModel = pair.faceSide.model();
    const std::uint32_t neighbour = faceModel.topology.across[pair.face.triangle][edge];
    if (neighbour == noNeighbour || (faceModel.solid && (pair.face.traits & (concaveEdge << edge)) == 0)) {
        return;
    }
    // The way to the line must lie between the normals of the two faces, and be one the corner can go.
    const Vector3f& from = pair.face.corner[edge];
    const Vector3f along = pair.face.corner[(edge + 1) % 3] - from;
    const float t = std::clamp((pair.point - from).dot(along) / along.squaredNorm(), 0.0F, 1.0F);
    const Vector3f way = from + t * along - pair.point;
    const float length = way.norm();
    const float turn = pair.face.normal.dot(pair.faceSide.directionToA(faceModel.triangleNormals[neighbour]));
    if (length < 8 * m_rounding || way.dot(pair.outward) < (turn - 1e-3F) * length ||
        !cornerFaces(pair.cornerSide, pair.vertex, -way / length, pair.lean)) {
        return;
    }
    const Vector3f local = pair.faceSide.pointFromA(pair.point);
    const auto closest = closestPoint(faceModel.tree, local, 1.01F * length);
    if (!closest || closest->feature == 6 || closest->distance < 8 * m_rounding) {
        return;  // (under a face: found with that face)
    }
    const Vector3f outer = pseudonormal(faceModel, closest->triangle, closest->feature);
    const Vector3f onFace = pair.faceSide.pointToA(closest->point);
    if (faceModel.solid ? (local - closest->point).dot(outer) >= 0 : !insideOwnBody(pair, onFace)) {
        return;
    }
    const std::uint64_t key = meshFeatureKey(faceModel, closest->triangle, closest->feature);
    const Vector3f outward = (onFace - pair.point) / closest->distance;
    if (counts(pair.triangle, pair.face, -closest->distance) && isNew(pair.cornerSide, pair.vertex, key) &&
        cornerFaces(pair.cornerSide, pair.vertex, -outward, pair.lean)) {
        add(pair.cornerSide, pair.vertex, key,
            {pair.point, onFace, outward, -closest->distance, noTriangle, closest->triangle});
    }
}

void FeatureContacts::edges(const PlacedTriangle& a, unsigned edgeA, const PlacedTriangle& b, unsigned edgeB) {
    if ((a.traits & (bentEdges(m_a->model()) << edgeA)) == 0 || (b.traits & (bentEdges(m_b->model()) << edgeB)) == 0) {
        return;
    }
    const FeaturePairKey key{meshFeatureKey(m_a->model(), a.triangle, static_cast<int>(edgeA) + 3),
                             meshFeatureKey(m_b->model(), b.triangle, static_cast<int>(edgeB) + 3)};
    const SurfaceEdge onA = m_a->edge(a, edgeA);
    const SurfaceEdge onB = m_b->edge(b, edgeB);
    const EdgeContacts found = edgeContacts(onA, onB, m_settings.lean, m_rounding);
    const auto isPossible = [&](const SurfaceContact& contact) {
        return contact.signedDistance <= m_settings.maxDistance && counts(a, b, contact.signedDistance);
    };
    if (!std::any_of(found.contact, found.contact + found.count, isPossible) ||
        !m_collector->isNew(key, noTriangle, noTriangle)) {
        return;
    }
    for (int i = 0; i < found.count; ++i) {
        SurfaceContact contact = found.contact[i];
        contact.triangleA = m_a->firstTriangle(a.triangle, edgeA);
        contact.triangleB = m_b->firstTriangle(b.triangle, edgeB);
        if (contact.signedDistance <= m_settings.maxDistance &&
            (contact.signedDistance >= 0 || reallyCrossed(onA, onB, contact))) {
            m_collector->add(key, contact);
        }
    }
}

/// Edges have passed each other: is each, pulled into both bodies, really inside the other's?
bool FeatureContacts::reallyCrossed(const SurfaceEdge& onA, const SurfaceEdge& onB,
                                    const SurfaceContact& contact) const {
    const float depth = -contact.signedDistance;
    if (depth < 8 * m_rounding) {
        return true;
    }
    const Vector3f inwards = (onA.own + onA.across).normalized() + (onB.own + onB.across).normalized();
    const Vector3f shift = -pull * depth * inwards;
    constexpr float anyDistance = std::numeric_limits<float>::infinity();
    return isInside(m_a->model(), contact.onB + shift, anyDistance) &&
           isInside(m_b->model(), m_b->pointFromA(contact.onA + shift), anyDistance);
}

/// An edge or a corner that another corner is nearest to.
struct FeatureContacts::Rim {
    const MeshSide& side;
    const PlacedTriangle& triangle;
    int feature;     // 0..2 corner, 3..5 edge
    Vector3f point;  // on it
    [[nodiscard]] unsigned index() const { return static_cast<unsigned>(feature % 3); }
};

void FeatureContacts::cornerAndEdge(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                                    const MeshSide& edgeSide, const PlacedTriangle& other, unsigned edge) {
    if ((other.traits & (bentEdges(edgeSide.model()) << edge)) == 0) {
        return;
    }
    const SurfaceEdge on = edgeSide.edge(other, edge);
    const Vector3f along = on.to - on.from;
    const float t = (triangle.corner[corner] - on.from).dot(along) / along.squaredNorm();
    if (t > 0 && t < 1) {  // beyond its ends are its corners
        cornerOnRim(cornerSide, triangle, corner,
                    {edgeSide, other, static_cast<int>(edge) + 3, Vector3f(on.from + t * along)});
    }
}

void FeatureContacts::corners(const PlacedTriangle& a, unsigned cornerA, const PlacedTriangle& b, unsigned cornerB) {
    if ((b.traits & (flatCorner << cornerB)) == 0) {
        cornerOnRim(*m_a, a, cornerA, {*m_b, b, static_cast<int>(cornerB), b.corner[cornerB]});
    }
}

/// A corner beyond an edge or before a corner of the other side.
void FeatureContacts::cornerOnRim(const MeshSide& cornerSide, const PlacedTriangle& triangle, unsigned corner,
                                  const Rim& rim) {
    const Vector3f& point = triangle.corner[corner];
    float distance = (point - rim.point).norm();
    if ((triangle.traits & (flatCorner << corner)) != 0 || !(distance <= m_settings.maxDistance + m_rounding) ||
        distance < 8 * m_rounding) {  // nothing tells the direction: corners on faces and crossing edges do
        return;
    }
    const MeshModel& rimModel = rim.side.model();
    const std::uint32_t vertex = cornerSide.weldedCorner(triangle.triangle, corner);
    const std::uint64_t key = meshFeatureKey(rimModel, rim.triangle.triangle, rim.feature);
    if (!isNew(cornerSide, vertex, key)) {
        return;
    }
    const Vector3f rimNormal =
        rim.side.directionToA(pseudonormal(rimModel, rim.triangle.triangle, rim.feature)).normalized();
    Vector3f outward = (point - rim.point) / distance;
    const float lean = std::min(0.1F, exactLean + m_rounding / (distance + m_rounding));
    const Vector3f towardsCorner = rim.side.directionFromA(outward);
    const bool isEdge = rim.feature >= 3;
    if ((rimModel.solid && rimNormal.dot(outward) <= 0) || !cornerFaces(cornerSide, vertex, -outward, lean) ||
        !(isEdge ? edgeIsExtremal(rimModel, rim.triangle.triangle, rim.index(), towardsCorner, lean)
                 : cornerIsExtremal(rimModel, rim.side.weldedCorner(rim.triangle.triangle, rim.index()), towardsCorner,
                                    lean))) {
        return;
    }
    if (isEdge) {
        outward = snapped(rim.side.edge(rim.triangle, rim.index()), outward);
    }
    distance = (point - rim.point).dot(outward);
    if (distance <= m_settings.maxDistance) {
        const std::uint32_t rimTriangle =
            isEdge ? rim.side.firstTriangle(rim.triangle.triangle, rim.index())
                   : rimModel.vertexTriangle[rim.side.weldedCorner(rim.triangle.triangle, rim.index())];
        add(cornerSide, vertex, key, {point, point - distance * outward, outward, distance, noTriangle, rimTriangle});
    }
}

bool FeatureContacts::isNew(const MeshSide& cornerSide, std::uint32_t vertex, std::uint64_t other) {
    const std::uint64_t corner = cornerKey(vertex);
    return m_collector->isNew(cornerSide.isA() ? FeaturePairKey{corner, other} : FeaturePairKey{other, corner},
                              noTriangle, noTriangle);
}

/// `contact` as the corner's side sees it: the corner is A's, the normal points towards it.
void FeatureContacts::add(const MeshSide& cornerSide, std::uint32_t vertex, std::uint64_t other,
                          const SurfaceContact& contact) {
    const std::uint64_t corner = cornerKey(vertex);
    const std::uint32_t cornerTriangle = cornerSide.model().vertexTriangle[vertex];
    if (cornerSide.isA()) {
        m_collector->add({corner, other}, {contact.onA, contact.onB, contact.normal, contact.signedDistance,
                                           cornerTriangle, contact.triangleB});
    } else {
        m_collector->add({other, corner}, {contact.onB, contact.onA, -contact.normal, contact.signedDistance,
                                           contact.triangleB, cornerTriangle});
    }
}

}  // namespace grapeshot::detail
