#include <grapeshot/plugin/detail/gjk_contacts.hpp>

#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Eigen::Vector3f;

// More corners than that: GJK alone has to do.
constexpr int mostCorners = 256;

/// Which feature of the triangle the point is on: 0..2 corner, 3..5 edge, 6 face; within a small part of its size.
int featureAt(const std::array<Vector3f, 3>& corner, const Vector3f& point) {
    const Vector3f normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const float area = normal.squaredNorm();
    if (!(area > 0)) {
        return 0;
    }
    std::array<float, 3> weight;
    int near = 0;  // bit e: the point is on the edge opposite corner e
    for (std::size_t c = 0; c < 3; ++c) {
        const Vector3f& from = corner[(c + 1) % 3];
        const Vector3f& to = corner[(c + 2) % 3];
        weight[c] = (to - from).cross(point - from).dot(normal) / area;
        near |= weight[c] < 1e-3F ? 1 << c : 0;
    }
    if (near == 0) {
        return 6;
    }
    if ((near & (near - 1)) != 0) {
        return static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    }
    // Edge e runs from corner e to the next: opposite corner e + 2.
    return near == 1 ? 4 : near == 2 ? 5 : 3;
}

/// 0: none, or too many to be asked.
int cornersOf(const btConvexShape& convex) {
    const int count = convex.isPolyhedral() ? static_cast<const btPolyhedralConvexShape&>(convex).getNumVertices() : 0;
    return count > mostCorners ? 0 : count;
}

SearchRegion regionAround(const btConvexShape& convex, const btTransform& inMesh, float maxDistance) {
    btVector3 lower;
    btVector3 upper;
    convex.getAabb(inMesh, lower, upper);
    const Vector3f reach = Vector3f::Constant(maxDistance);
    return SearchRegion::inBox(toEigen(lower) - reach, toEigen(upper) + reach);
}

class Finder {
  public:
    Finder(const MeshModel& mesh, const btConvexShape& convex, const btTransform& inMesh, float maxDistance,
           const LocalContactSettings& settings, std::vector<SurfaceContact>& out, LeafChoice* choice)
        : m_mesh(mesh),
          m_convex(convex),
          m_inMesh(inMesh),
          m_maxDistance(maxDistance),
          m_settings(settings),
          m_out(out),
          m_choice(choice),
          m_margin(convex.getMargin()) {}

    std::uint64_t run() {
        thread_local std::vector<std::uint32_t> near;
        near.clear();
        if (m_choice == nullptr) {
            const SearchRegion region = regionAround(m_convex, m_inMesh, m_maxDistance);
            leavesInBox(m_mesh.tree, region.lower, region.upper, near);
        } else {
            near.assign(m_choice->leaves.begin(), m_choice->leaves.end());
        }
        const std::size_t before = m_out.size();
        std::uint64_t tested = 0;
        for (const std::uint32_t leaf : near) {
            for (const std::uint32_t triangle : m_mesh.tree.leaves[leaf].triangle) {
                if (triangle != noTriangle) {
                    triangleContact(triangle);
                    ++tested;
                }
            }
        }
        if (!near.empty()) {
            tested += corners();
        }
        if (m_mesh.solid && m_out.size() == before && (m_choice == nullptr || m_choice->all)) {
            engulfed();
        }
        return (tested + 3) / 4;
    }

  private:
    /// Farthest point of the solid in a direction (unit, mesh frame), margin included.
    [[nodiscard]] Vector3f support(const Vector3f& direction) const {
        const btVector3 local = m_inMesh.getBasis().transpose() * toBullet(direction);
        return toEigen(m_inMesh * m_convex.localGetSupportingVertex(local));
    }

    void triangleContact(std::uint32_t triangle) {
        const Triangle& index = m_mesh.tree.triangles[triangle];
        const std::array<Vector3f, 3> corner{m_mesh.tree.vertices[index[0]], m_mesh.tree.vertices[index[1]],
                                             m_mesh.tree.vertices[index[2]]};
        btTriangleShape shape(toBullet(corner[0]), toBullet(corner[1]), toBullet(corner[2]));
        shape.setMargin(0);
        btGjkPairDetector::ClosestPointInput input;
        input.m_transformA.setIdentity();
        input.m_transformB = m_inMesh;
        const btScalar reach = btScalar(m_maxDistance) + m_margin;
        input.m_maximumDistanceSquared = reach * reach;
        m_simplex.reset();
        btGjkPairDetector detector(&shape, &m_convex, TRIANGLE_SHAPE_PROXYTYPE, m_convex.getShapeType(), 0, m_margin,
                                   &m_simplex, &m_depth);
        btPointCollector found;
        detector.getClosestPoints(input, found, nullptr);
        if (!found.m_hasResult || !isFinite(found.m_pointInWorld) || !isFinite(found.m_normalOnBInWorld)) {
            return;
        }
        SurfaceContact contact;
        contact.normal = toEigen(found.m_normalOnBInWorld).normalized();
        contact.signedDistance = static_cast<float>(found.m_distance);
        contact.onB = toEigen(found.m_pointInWorld);
        // Where the bare shapes just touch, Bullet's point is anywhere along the normal.
        const Vector3f& face = m_mesh.triangleNormals[triangle];
        const float across = contact.normal.dot(face);
        if (std::abs(across) > 0.5F) {
            const Vector3f onA = contact.onB + contact.normal * contact.signedDistance;
            contact.onB += contact.normal * ((corner[0] - onA).dot(face) / across);
        }
        contact.onA = contact.onB + contact.normal * contact.signedDistance;
        contact.triangleA = triangle;
        if (!(contact.signedDistance <= m_maxDistance)) {
            return;
        }
        const int feature = featureAt(corner, contact.onA);
        if (isLocalExtremum(m_mesh, triangle, feature, -contact.normal, m_settings)) {
            m_out.push_back(contact);
        } else if (contact.signedDistance < 0) {
            throughFace(triangle, corner);
        }
    }

    /// The solid sticks through the triangle, and the shortest way out is the wrong one: back through the face, if what
    /// is deepest is below it.
    void throughFace(std::uint32_t triangle, const std::array<Vector3f, 3>& corner) {
        const Vector3f& outward = m_mesh.triangleNormals[triangle];
        if (!m_mesh.solid || outward.isZero()) {
            return;
        }
        const Vector3f deepest = support(-outward);
        const float height = (deepest - corner[0]).dot(outward);
        const Vector3f onFace = deepest - height * outward;
        for (std::size_t e = 0; e < 3; ++e) {
            const Vector3f along = corner[(e + 1) % 3] - corner[e];
            if (outward.cross(along).dot(onFace - corner[e]) < 0) {
                return;
            }
        }
        if (height < 0) {
            m_out.push_back({onFace, deepest, -outward, height, triangle, noTriangle});
        }
    }

    /// Corners of a polyhedron against the surface. If a budget does not last for all, others come first in each step.
    std::uint64_t corners() {
        const int count = cornersOf(m_convex);
        if (count == 0) {
            return 0;
        }
        const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(m_convex);
        int asked = count;
        int first = 0;
        if (m_choice != nullptr) {
            const std::uint64_t left = m_choice->purse.left().work;
            const std::uint64_t wanted = (static_cast<std::uint64_t>(count) + 3) / 4;
            asked = left >= wanted ? count : static_cast<int>(4 * left);
            m_choice->complete = m_choice->complete && asked == count;
            m_choice->purse.pay(std::min(left, wanted));
            first = asked == count ? 0 : static_cast<int>(m_choice->turn % static_cast<std::uint64_t>(count));
        }
        const auto margin = static_cast<float>(m_margin);
        const Vector3f reach = Vector3f::Constant(m_maxDistance + margin);
        // A corner inside is a contact however deep; the mesh's own size bounds how far out is.
        const float farthest = m_mesh.solid ? 2 * m_mesh.tree.radius : m_maxDistance + margin;
        for (int i = 0; i < asked; ++i) {
            btVector3 local;
            polyhedron.getVertex((first + i) % count, local);
            const Vector3f vertex = toEigen(m_inMesh * local);
            if (((vertex - m_mesh.tree.lower + reach).array() < 0).any() ||
                ((m_mesh.tree.upper + reach - vertex).array() < 0).any()) {
                continue;
            }
            const auto closest = closestPoint(m_mesh.tree, vertex, farthest);
            if (closest) {
                cornerContact(vertex, *closest, margin);
            }
        }
        return static_cast<std::uint64_t>(asked);
    }

    void cornerContact(const Vector3f& vertex, const ClosestPoint& closest, float margin) {
        if (closest.feature != 6) {
            return;  // GJK's own case
        }
        const Vector3f& outward = m_mesh.triangleNormals[closest.triangle];
        float side = (vertex - closest.point).dot(outward) < 0 ? -1.0F : 1.0F;
        Vector3f normal = -outward;
        if (!m_mesh.solid) {
            // A sheet's side is where the solid is.
            const Vector3f toMiddle = toEigen(m_inMesh.getOrigin()) - closest.point;
            const float middleSide = toMiddle.dot(outward) < 0 ? -1.0F : 1.0F;
            normal *= middleSide;
            side *= middleSide;
        }
        const float distance = side * closest.distance - margin;
        if (distance <= m_maxDistance) {
            m_out.push_back(
                {closest.point, closest.point - normal * distance, normal, distance, closest.triangle, noTriangle});
        }
    }

    /// Nothing found: is the solid wholly inside? Then out by the shortest way from its middle.
    void engulfed() {
        const Vector3f middle = toEigen(m_inMesh.getOrigin());
        if ((middle.array() < m_mesh.tree.lower.array()).any() || (middle.array() > m_mesh.tree.upper.array()).any() ||
            !contains(m_mesh.tree, middle)) {
            return;
        }
        const auto closest = closestPoint(m_mesh.tree, middle, 2 * m_mesh.tree.radius);
        if (!closest || !(closest->distance > 0)) {
            return;
        }
        const Vector3f out = (closest->point - middle) / closest->distance;
        const Vector3f last = support(-out);
        const float depth = (closest->point - last).dot(out);
        m_out.push_back({last + depth * out, last, -out, -depth, closest->triangle, noTriangle});
    }

    const MeshModel& m_mesh;
    const btConvexShape& m_convex;
    btTransform m_inMesh;
    float m_maxDistance;
    LocalContactSettings m_settings;
    std::vector<SurfaceContact>& m_out;
    LeafChoice* m_choice;
    btScalar m_margin;
    btVoronoiSimplexSolver m_simplex;
    btGjkEpaPenetrationDepthSolver m_depth;
};

}  // namespace

ConvexSolid::ConvexSolid(const btConvexShape& convex, const btTransform& inMesh) : m_convex(convex), m_inMesh(inMesh) {
    btVector3 lower;
    btVector3 upper;
    convex.getAabb(btTransform::getIdentity(), lower, upper);
    m_box.pose = toPose(btTransform(inMesh.getBasis(), inMesh * ((lower + upper) / 2)));
    m_box.half = toEigen((upper - lower) / 2);
}

float ConvexSolid::distanceBound(const Vector3f& center, const Vector3f& half) const {
    return boxDistanceBound(m_box, center, half);
}

std::uint64_t ConvexSolid::regions(const MeshModel&, float maxDistance, std::vector<SearchRegion>& out) const {
    out.push_back(regionAround(m_convex, m_inMesh, maxDistance));
    return (static_cast<std::uint64_t>(cornersOf(m_convex)) + 3) / 4;
}

std::uint64_t ConvexSolid::contacts(const MeshModel& mesh, float maxDistance, const LocalContactSettings& settings,
                                    std::vector<SurfaceContact>& out, LeafChoice* choice) const {
    return Finder(mesh, m_convex, m_inMesh, maxDistance, settings, out, choice).run();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
