#include "bullet_importer.hpp"

#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <BulletFileLoader/btBulletFile.h>

#include <cmath>
#include <type_traits>

namespace grapeshot::import::detail {
namespace {

template <class Data>
btVector3 vectorOf(const Data& data) {
    return {btScalar(data.m_floats[0]), btScalar(data.m_floats[1]), btScalar(data.m_floats[2])};
}

bool isFinite(const btVector3& v) {
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

void forgetHierarchy(btTriangleMeshShapeData& mesh) {
    mesh.m_quantizedFloatBvh = nullptr;
    mesh.m_quantizedDoubleBvh = nullptr;
    mesh.m_triangleInfoMap = nullptr;
}

bool isDouble(bParse::btBulletFile& file) {
    return (file.getFlags() & bParse::FD_DOUBLE_PRECISION) != 0;
}

}  // namespace

bool BulletImporter::convertAllObjects(bParse::btBulletFile* file) {
    m_shapeMap.clear();
    m_bodyMap.clear();
    m_bvhMap.clear();
    m_timMap.clear();
    convertShapes(*file);
    convertWorldInfo(*file);
    for (int i = 0; i < file->m_rigidBodies.size(); ++i) {
        void* data = file->m_rigidBodies[i];
        isDouble(*file) ? convertBody(*static_cast<btRigidBodyDoubleData*>(data))
                        : convertBody(*static_cast<btRigidBodyFloatData*>(data));
    }
    for (int i = 0; i < file->m_collisionObjects.size(); ++i) {
        void* data = file->m_collisionObjects[i];
        isDouble(*file) ? convertObject(*static_cast<btCollisionObjectDoubleData*>(data))
                        : convertObject(*static_cast<btCollisionObjectFloatData*>(data));
    }
    convertConstraints(*file);
    return true;
}

void BulletImporter::convertShapes(bParse::btBulletFile& file) {
    const auto dataOf = [&](int i) { return reinterpret_cast<btCollisionShapeData*>(file.m_collisionShapes[i]); };
    for (int i = 0; i < file.m_collisionShapes.size(); ++i) {
        if (dataOf(i)->m_shapeType == TRIANGLE_MESH_SHAPE_PROXYTYPE) {
            forgetHierarchy(*reinterpret_cast<btTriangleMeshShapeData*>(dataOf(i)));
        } else if (dataOf(i)->m_shapeType == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE) {
            forgetHierarchy(reinterpret_cast<btScaledTriangleMeshShapeData*>(dataOf(i))->m_trimeshShapeData);
        }
    }
    for (int i = 0; i < file.m_collisionShapes.size(); ++i) {
        btCollisionShapeData* data = dataOf(i);
        const int type = data->m_shapeType;
        btCollisionShape* shape = type == GIMPACT_SHAPE_PROXYTYPE
                                      ? convertGImpact(*reinterpret_cast<btGImpactMeshShapeData*>(data))
                                      : convertCollisionShape(data);
        m_summary.gimpactShapes += type == GIMPACT_SHAPE_PROXYTYPE && shape != nullptr ? 1 : 0;
        m_summary.meshShapes += shape != nullptr && btBroadphaseProxy::isConcave(type) &&
                                        type != STATIC_PLANE_PROXYTYPE && type != TERRAIN_SHAPE_PROXYTYPE
                                    ? 1
                                    : 0;
        if (shape != nullptr) {
            m_shapeMap.insert(static_cast<const void*>(data), shape);
        }
    }
}

btCollisionShape* BulletImporter::convertGImpact(btGImpactMeshShapeData& data) {
    if (data.m_gimpactSubType != CONST_GIMPACT_TRIMESH_SHAPE) {
        return nullptr;
    }
    btStridingMeshInterfaceData* meshData = createStridingMeshInterfaceData(&data.m_meshInterface);
    btTriangleIndexVertexArray* arrays = createMeshInterface(*meshData);
    if (arrays->getNumSubParts() == 0) {
        return nullptr;
    }
    auto* shape = new btGImpactMeshShape(arrays);
    m_allocatedCollisionShapes.push_back(shape);
    shape->setLocalScaling(vectorOf(data.m_localScaling));
    shape->setMargin(btScalar(data.m_collisionMargin));
    shape->updateBound();
    return shape;
}

void BulletImporter::convertWorldInfo(bParse::btBulletFile& file) {
    if (file.m_dynamicsWorldInfo.size() == 0) {
        return;
    }
    const void* data = file.m_dynamicsWorldInfo[0];
    const btVector3 gravity = isDouble(file) ? vectorOf(static_cast<const btDynamicsWorldDoubleData*>(data)->m_gravity)
                                             : vectorOf(static_cast<const btDynamicsWorldFloatData*>(data)->m_gravity);
    const int iterations = isDouble(file)
                               ? static_cast<const btDynamicsWorldDoubleData*>(data)->m_solverInfo.m_numIterations
                               : static_cast<const btDynamicsWorldFloatData*>(data)->m_solverInfo.m_numIterations;
    if (isFinite(gravity)) {
        m_dynamicsWorld->setGravity(gravity);
    }
    if (iterations > 0 && iterations <= 1000) {
        m_dynamicsWorld->getSolverInfo().m_numIterations = iterations;
    }
}

template <class Data>
void BulletImporter::convertBody(Data& data) {
    if constexpr (std::is_same_v<Data, btRigidBodyFloatData>) {
        convertRigidBodyFloat(&data);
    } else {
        convertRigidBodyDouble(&data);
    }
    btCollisionObject** found = m_bodyMap.find(static_cast<const void*>(&data));
    btRigidBody* body = found != nullptr ? btRigidBody::upcast(*found) : nullptr;
    if (body == nullptr) {
        ++m_summary.droppedBodies;
        return;
    }
    ++m_summary.bodies;
    m_summary.moving += body->isStaticOrKinematicObject() ? 0 : 1;
    const btVector3 inverseInertia = vectorOf(data.m_invInertiaLocal);
    if (body->getInvMass() > 0 && isFinite(inverseInertia) && !inverseInertia.isZero()) {
        body->setInvInertiaDiagLocal(inverseInertia);
        body->updateInertiaTensor();
    }
    if (isFinite(vectorOf(data.m_linearVelocity)) && isFinite(vectorOf(data.m_angularVelocity))) {
        body->setLinearVelocity(vectorOf(data.m_linearVelocity));
        body->setAngularVelocity(vectorOf(data.m_angularVelocity));
    }
    body->setDamping(btScalar(data.m_linearDamping), btScalar(data.m_angularDamping));
}

/// As Bullet's importer does it, which has no function for it.
template <class Data>
void BulletImporter::convertObject(Data& data) {
    btCollisionShape** shape = m_shapeMap.find(static_cast<const void*>(data.m_collisionShape));
    if (shape == nullptr || *shape == nullptr) {
        ++m_summary.droppedBodies;
        return;
    }
    btTransform pose;
    if constexpr (std::is_same_v<Data, btCollisionObjectFloatData>) {
        pose.deSerializeFloat(data.m_worldTransform);
    } else {
        pose.deSerializeDouble(data.m_worldTransform);
    }
    btCollisionObject* object = createCollisionObject(pose, *shape, data.m_name);
    object->setFriction(btScalar(data.m_friction));
    object->setRestitution(btScalar(data.m_restitution));
    m_bodyMap.insert(static_cast<const void*>(&data), object);
    ++m_summary.bodies;
}

void BulletImporter::convertConstraints(bParse::btBulletFile& file) {
    const auto bodyOf = [&](const void* data) -> btRigidBody* {
        btCollisionObject** found = m_bodyMap.find(data);
        if (found == nullptr) {
            return nullptr;
        }
        btRigidBody* body = btRigidBody::upcast(*found);
        return body != nullptr ? body : &getFixedBody();
    };
    for (int i = 0; i < file.m_constraints.size(); ++i) {
        void* data = file.m_constraints[i];
        const auto* common = static_cast<const btTypedConstraintData*>(data);
        btRigidBody* a = bodyOf(common->m_rbA);
        btRigidBody* b = bodyOf(common->m_rbB);
        if ((common->m_rbA != nullptr && a == nullptr) || (common->m_rbB != nullptr && b == nullptr) ||
            (a == nullptr && b == nullptr)) {
            continue;  // with a body that was dropped
        }
        if (file.getVersion() < 282) {
            convertConstraintBackwardsCompatible281(static_cast<btTypedConstraintData*>(data), a, b, file.getVersion());
        } else if (isDouble(file)) {
            convertConstraintDouble(static_cast<btTypedConstraintDoubleData*>(data), a, b, file.getVersion());
        } else {
            convertConstraintFloat(static_cast<btTypedConstraintFloatData*>(data), a, b, file.getVersion());
        }
    }
    m_summary.constraints = getNumConstraints();
}

}  // namespace grapeshot::import::detail
