#include <grapeshot/plugin/detail/solid_contacts.hpp>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <limits>

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

namespace {

/// Calls `use` with the solid as narrowphase/ sees it.
template <class Use>
auto withSolid(const PlacedSolid& solid, Use&& use) {
    switch (solid.shape->getShapeType()) {
        case STATIC_PLANE_PROXYTYPE:
            return use(PlacedPlane(planeOf(static_cast<const btStaticPlaneShape&>(*solid.shape), solid.inMesh)));
        case SPHERE_SHAPE_PROXYTYPE: {
            const Eigen::Vector3f center = toEigen(solid.inMesh.getOrigin());
            const btScalar radius = static_cast<const btSphereShape&>(*solid.shape).getRadius();
            return use(PlacedCapsule({center, center, static_cast<float>(radius)}));
        }
        case CAPSULE_SHAPE_PROXYTYPE:
            return use(PlacedCapsule(capsuleOf(static_cast<const btCapsuleShape&>(*solid.shape), solid.inMesh)));
        case BOX_SHAPE_PROXYTYPE: {
            const auto& box = static_cast<const btBoxShape&>(*solid.shape);
            return use(PlacedBox({toPose(solid.inMesh), toEigen(box.getHalfExtentsWithMargin())}));
        }
        default:
            return use(ConvexSolid(static_cast<const btConvexShape&>(*solid.shape), solid.inMesh));
    }
}

}  // namespace

PairResult updateSolid(const MeshModel& mesh, const PlacedSolid& solid, const Pose& pose, const PairSettings& settings,
                       const Budget& budget, PairState& state) {
    return withSolid(solid, [&](const Solid& placed) {
        return grapeshot::updateSolid(mesh, placed, pose, settings, budget, state);
    });
}

std::uint64_t solidContacts(const MeshModel& mesh, const PlacedSolid& solid, const LocalContactSettings& settings,
                            const Budget& budget, std::vector<SurfaceContact>& out) {
    return withSolid(solid, [&](const Solid& placed) { return solidContactsAt(mesh, placed, settings, budget, out); });
}

bool asksBullet(const btCollisionShape& solid) {
    switch (solid.getShapeType()) {
        case STATIC_PLANE_PROXYTYPE:
        case SPHERE_SHAPE_PROXYTYPE:
        case CAPSULE_SHAPE_PROXYTYPE:
        case BOX_SHAPE_PROXYTYPE:
            return false;
        default:
            return true;
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
