#include <grapeshot/plugin/detail/stop_points.hpp>

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <Eigen/Geometry>
#include <algorithm>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Eigen::Vector3f;

constexpr std::size_t mostVertices = 64;
/// Radians by which the body may turn about the place where it touches, in the rest of the step. For the solver a turn
/// is a straight way, and Bullet cuts turns of more than pi / 4 short, but not the way that goes with them.
constexpr float mostTurn = 0.2F;

/// One of the two bodies, in a frame of its own.
struct Side {
    const MeshModel* mesh = nullptr;  // null: solid
    const btCollisionShape* shape = nullptr;
    float radius = 0;

    [[nodiscard]] Vector3f farthest(const Vector3f& direction) const {
        if (mesh == nullptr) {
            const auto& convex = static_cast<const btConvexShape&>(*shape);
            return toEigen(convex.localGetSupportingVertex(toBullet(direction)));
        }
        const auto& vertices = mesh->tree.vertices;
        const std::size_t stride = (vertices.size() + mostVertices - 1) / mostVertices;
        Vector3f best = vertices[0];
        for (std::size_t i = 0; i < vertices.size(); i += stride) {
            if (vertices[i].dot(direction) > best.dot(direction)) {
                best = vertices[i];
            }
        }
        return best;
    }
    [[nodiscard]] bool isNear(const Vector3f& point, float distance) const {
        if (mesh != nullptr) {
            return closestPoint(mesh->tree, point, distance).has_value();
        }
        if (shape->getShapeType() == STATIC_PLANE_PROXYTYPE) {
            return true;
        }
        btVector3 lower;
        btVector3 upper;
        shape->getAabb(btTransform::getIdentity(), lower, upper);
        const Vector3f around = Vector3f::Constant(distance);
        return ((point + around - toEigen(lower)).array() >= 0).all() &&
               ((toEigen(upper) + around - point).array() >= 0).all();
    }
};

}  // namespace

void stopPoints(const PairShapes& shapes, const PairSize& size, const FirstTouch& touch, RegionSlot& slot) {
    Side a{shapes.modelA->mesh.get(), shapes.a->getCollisionShape(), shapes.modelA->mesh->tree.radius};
    Side b{shapes.modelB ? shapes.modelB->mesh.get() : nullptr, shapes.b->getCollisionShape(), 0};
    b.radius = b.mesh != nullptr ? b.mesh->tree.radius : sizeOf(*b.shape).halfDiagonal;
    const bool moverIsA = a.radius <= b.radius;
    const Side& mover = moverIsA ? a : b;
    const Side& other = moverIsA ? b : a;
    const Pose identity;
    const Pose& moverThen = moverIsA ? identity : touch.then;
    const Pose& moverNow = moverIsA ? identity : touch.now;
    const Pose otherThen = inverse(moverIsA ? touch.then : identity);
    // Out of the other one, to the mover.
    const Vector3f out = moverIsA ? touch.contact.normal : Vector3f(-touch.contact.normal);
    const Vector3f& onOther = moverIsA ? touch.contact.onB : touch.contact.onA;
    const Vector3f along = out.unitOrthogonal();
    const Vector3f across = out.cross(along);
    const Vector3f normalInB = touch.now.rotation.transpose() * touch.normalNow;
    // The plane as it is now: fixed to the other body.
    const Vector3f onOtherNow = moverIsA ? apply(touch.now, apply(inverse(touch.then), onOther)) : onOther;

    slot.count = 0;
    slot.normalInB = normalInB;
    for (const Vector3f& side : {along, Vector3f(-along), across, Vector3f(-across)}) {
        const Vector3f local = mover.farthest(moverThen.rotation.transpose() * (side - 0.1F * out));
        const Vector3f there = apply(moverThen, local);
        const float thereAbove = out.dot(there - onOther);
        const Vector3f onPlane = there - out * thereAbove;
        if (!other.isNear(apply(otherThen, onPlane), size.size)) {
            continue;
        }
        const Vector3f here = apply(moverNow, local);
        const Vector3f outNow = moverIsA ? touch.normalNow : Vector3f(-touch.normalNow);
        const float above = outNow.dot(here - onOtherNow);
        if (above < 0) {
            continue;  // it is past it already, which is the contacts' own business
        }
        const float further = std::min(thereAbove, mostTurn * (onPlane - onOther).norm());
        const float distance = std::max(0.0F, above - thereAbove + further);
        const Vector3f foot = here - distance * outNow;
        PersistentPoint& point = slot.points[static_cast<std::size_t>(slot.count++)];
        point = {};
        point.localA = moverIsA ? here : foot;
        point.localB = apply(inverse(touch.now), moverIsA ? foot : here);
        point.normalInB = normalInB;
        point.signedDistance = distance;
        point.triangleA = touch.contact.triangleA;
        point.triangleB = touch.contact.triangleB;
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
