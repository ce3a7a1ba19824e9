#include <grapeshot/plugin/detail/solid_contacts.hpp>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <limits>

#include <grapeshot/narrowphase/convex_contacts.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/gjk_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

PlaneSolid planeOf(const btStaticPlaneShape& shape, const btTransform& inMesh) {
    const btVector3 normal = (inMesh.getBasis() * shape.getPlaneNormal()).normalized();
    return {toEigen(normal), static_cast<float>(shape.getPlaneConstant() + normal.dot(inMesh.getOrigin()))};
}

CapsuleSolid capsuleOf(const btCapsuleShape& shape, const btTransform& inMesh) {
    btVector3 end(0, 0, 0);
    end[shape.getUpAxis()] = shape.getHalfHeight();
    return {toEigen(inMesh * -end), toEigen(inMesh * end), static_cast<float>(shape.getRadius())};
}

}  // namespace

btScalar marginBeyond(const btCollisionShape& solid) {
    const btScalar margin = solid.getShapeType() == STATIC_PLANE_PROXYTYPE ? solid.getMargin() : btScalar(0);
    return margin > 0 ? margin : btScalar(0);
}

SolidSize sizeOf(const btCollisionShape& solid) {
    if (solid.getShapeType() == STATIC_PLANE_PROXYTYPE) {
        return {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
    }
    btVector3 lower;
    btVector3 upper;
    solid.getAabb(btTransform::getIdentity(), lower, upper);
    const Eigen::Vector3f extent = toEigen(upper - lower);
    return {extent.norm() / 2, extent.minCoeff()};
}

std::uint64_t solidContacts(const MeshModel& mesh, const PlacedSolid& solid, float maxDistance,
                            const LocalContactSettings& settings, std::vector<SurfaceContact>& out) {
    switch (solid.shape->getShapeType()) {
        case STATIC_PLANE_PROXYTYPE:
            return planeContacts(mesh, planeOf(static_cast<const btStaticPlaneShape&>(*solid.shape), solid.inMesh),
                                 maxDistance, settings, out);
        case SPHERE_SHAPE_PROXYTYPE: {
            const auto& sphere = static_cast<const btSphereShape&>(*solid.shape);
            return sphereContacts(mesh, {toEigen(solid.inMesh.getOrigin()), static_cast<float>(sphere.getRadius())},
                                  maxDistance, settings, out);
        }
        case CAPSULE_SHAPE_PROXYTYPE:
            return capsuleContacts(mesh, capsuleOf(static_cast<const btCapsuleShape&>(*solid.shape), solid.inMesh),
                                   maxDistance, settings, out);
        case BOX_SHAPE_PROXYTYPE: {
            const auto& box = static_cast<const btBoxShape&>(*solid.shape);
            return boxContacts(mesh, {toPose(solid.inMesh), toEigen(box.getHalfExtentsWithMargin())}, maxDistance,
                               settings, out);
        }
        default:
            return gjkContacts(mesh, static_cast<const btConvexShape&>(*solid.shape), solid.inMesh, maxDistance,
                               settings, out);
    }
}

bool isComplete(const btCollisionShape& solid) {
    switch (solid.getShapeType()) {
        case STATIC_PLANE_PROXYTYPE:
        case SPHERE_SHAPE_PROXYTYPE:
        case CAPSULE_SHAPE_PROXYTYPE:
        case BOX_SHAPE_PROXYTYPE:
            return true;
        default:
            return false;
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
