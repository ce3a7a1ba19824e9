#include <grapeshot/plugin/detail/shape_kind.hpp>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

eGIMPACT_SHAPE_TYPE gimpactKind(const btCollisionShape& shape) {
    return static_cast<const btGImpactShapeInterface&>(shape).getGImpactShapeType();
}

bool isOursAgainst(const btCollisionShape& mesh, const btCollisionShape& solid, const Settings& settings) {
    if (!isMesh(mesh) || !isSolid(solid)) {
        return false;
    }
    return isGImpact(mesh) ? settings.convexPairs
                           : solid.getShapeType() == STATIC_PLANE_PROXYTYPE || settings.bvhConvexPairs;
}

}  // namespace

bool isGImpact(const btCollisionShape& shape) {
    return shape.getShapeType() == GIMPACT_SHAPE_PROXYTYPE;
}

bool isGImpactCompound(const btCollisionShape& shape) {
    return isGImpact(shape) && gimpactKind(shape) == CONST_GIMPACT_COMPOUND_SHAPE;
}

bool isMesh(const btCollisionShape& shape) {
    const int type = shape.getShapeType();
    if (type == GIMPACT_SHAPE_PROXYTYPE) {
        return gimpactKind(shape) != CONST_GIMPACT_COMPOUND_SHAPE;
    }
    return type == TRIANGLE_MESH_SHAPE_PROXYTYPE || type == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE ||
           type == MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE || type == TERRAIN_SHAPE_PROXYTYPE;
}

bool isSolidType(int shapeType) {
    return shapeType == STATIC_PLANE_PROXYTYPE || btBroadphaseProxy::isConvex(shapeType);
}

bool isSolid(const btCollisionShape& shape) {
    return isSolidType(shape.getShapeType());
}

PairKind kindOf(const btCollisionShape& first, const btCollisionShape& second, const Settings& settings) {
    if (isMesh(first) && isMesh(second)) {
        return PairKind::meshMesh;
    }
    if (isOursAgainst(first, second, settings)) {
        return PairKind::meshSolid;
    }
    return isOursAgainst(second, first, settings) ? PairKind::solidMesh : PairKind::foreign;
}

btScalar marginOf(const btCollisionShape& mesh) {
    btScalar margin = mesh.getMargin();
    if (isGImpact(mesh) && gimpactKind(mesh) == CONST_GIMPACT_TRIMESH_SHAPE) {
        const auto& whole = static_cast<const btGImpactMeshShape&>(mesh);
        for (int i = 0; i < whole.getMeshPartCount(); ++i) {
            margin = i == 0 ? whole.getMeshPart(i)->getMargin() : btMax(margin, whole.getMeshPart(i)->getMargin());
        }
    }
    return margin > 0 ? margin : btScalar(0);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
