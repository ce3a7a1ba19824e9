// A Bullet world and mesh shapes for tests: everything owned, taken down in Bullet's order.
#pragma once

#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include <grapeshot/plugin.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::test {

/// btScalar literals.
constexpr btScalar operator""_s(long double value) {
    return static_cast<btScalar>(value);
}
constexpr btScalar operator""_s(unsigned long long value) {
    return static_cast<btScalar>(value);
}

inline btTransform at(const btVector3& origin, const btQuaternion& rotation = btQuaternion::getIdentity()) {
    return btTransform(rotation, origin);
}

enum class Kind { mesh, part, bvh, scaledBvh };
inline constexpr std::array allKinds{Kind::mesh, Kind::part, Kind::bvh, Kind::scaledBvh};

/// A mesh with the Bullet shape on top of it; the vertices can be edited in place.
class MeshShape {
  public:
    explicit MeshShape(scenes::Mesh source, Kind kind = Kind::mesh, btScalar margin = 0.01_s,
                       const btVector3& scale = {1, 1, 1})
        : mesh(std::move(source)) {
        arrays = std::make_unique<btTriangleIndexVertexArray>();
        addPart(mesh);
        make(kind, margin, scale);
    }
    /// Several parts.
    MeshShape(std::vector<scenes::Mesh> sources, Kind kind, btScalar margin = 0.01_s) : further(std::move(sources)) {
        arrays = std::make_unique<btTriangleIndexVertexArray>();
        for (scenes::Mesh& part : further) {
            addPart(part);
        }
        make(kind, margin, {1, 1, 1});
    }
    MeshShape(MeshShape&&) = default;

    btCollisionShape& operator*() const { return *shape; }
    btCollisionShape* operator->() const { return shape.get(); }
    btCollisionShape* get() const { return shape.get(); }

    scenes::Mesh mesh;
    std::vector<scenes::Mesh> further;
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btBvhTriangleMeshShape> child;  ///< of a scaled one
    std::unique_ptr<btCollisionShape> shape;

  private:
    void addPart(scenes::Mesh& part) {
        btIndexedMesh indexed;
        indexed.m_numTriangles = static_cast<int>(part.triangles.size());
        indexed.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(part.triangles.data());
        indexed.m_triangleIndexStride = sizeof(Triangle);
        indexed.m_numVertices = static_cast<int>(part.vertices.size());
        indexed.m_vertexBase = reinterpret_cast<const unsigned char*>(part.vertices.data());
        indexed.m_vertexStride = sizeof(Eigen::Vector3f);
        indexed.m_vertexType = PHY_FLOAT;
        arrays->addIndexedMesh(indexed, PHY_INTEGER);
    }
    void make(Kind kind, btScalar margin, const btVector3& scale) {
        switch (kind) {
            case Kind::mesh: {
                auto made = std::make_unique<btGImpactMeshShape>(arrays.get());
                made->setLocalScaling(scale);
                made->setMargin(margin);
                made->updateBound();
                shape = std::move(made);
                break;
            }
            case Kind::part: {
                auto made = std::make_unique<btGImpactMeshShapePart>(arrays.get(), 0);
                made->setLocalScaling(scale);
                made->setMargin(margin);
                made->updateBound();
                shape = std::move(made);
                break;
            }
            case Kind::bvh: {
                auto made = std::make_unique<btBvhTriangleMeshShape>(arrays.get(), true);
                if (!(scale == btVector3(1, 1, 1))) {
                    made->setLocalScaling(scale);
                }
                made->setMargin(margin);
                shape = std::move(made);
                break;
            }
            case Kind::scaledBvh:
                child = std::make_unique<btBvhTriangleMeshShape>(arrays.get(), true);
                shape = std::make_unique<btScaledBvhTriangleMeshShape>(child.get(), scale);
                shape->setMargin(margin);
                break;
        }
    }
};

/// Mass 0: static. `inertia` of zero: that of the shape by massProperties.
inline std::unique_ptr<btRigidBody> rigidBody(btCollisionShape& shape, const btTransform& pose, btScalar mass,
                                              btVector3 inertia = {0, 0, 0}) {
    if (mass > 0 && inertia.isZero()) {
        const MassProperties properties = massProperties(&shape, mass);
        inertia = properties.inertia;
        if (properties.status != Status::ok) {
            shape.calculateLocalInertia(mass, inertia);
        }
    }
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform = pose;
    return std::make_unique<btRigidBody>(info);
}

/// A world with our algorithms in it. Bodies leave with it, shapes are the caller's.
template <class AnyDispatcher>
class WorldWith {
  public:
    explicit WorldWith(const Settings& settings = {}, bool registered = true) {
        if (registered) {
            EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        }
        world.setGravity({0, -9.81_s, 0});
        world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    }
    ~WorldWith() {
        for (auto& body : bodies) {
            world.removeRigidBody(body.get());
        }
    }
    WorldWith(const WorldWith&) = delete;
    WorldWith& operator=(const WorldWith&) = delete;

    /// See rigidBody.
    btRigidBody& add(btCollisionShape& shape, const btTransform& pose, btScalar mass = 0,
                     btVector3 inertia = {0, 0, 0}) {
        bodies.push_back(rigidBody(shape, pose, mass, inertia));
        world.addRigidBody(bodies.back().get());
        return *bodies.back();
    }
    void remove(btRigidBody& body) {
        world.removeRigidBody(&body);
        std::erase_if(bodies, [&](const auto& owned) { return owned.get() == &body; });
    }
    void step(int count = 1, btScalar timeStep = 1.0_s / 60) {
        for (int i = 0; i < count; ++i) {
            world.stepSimulation(timeStep, 0);
        }
    }
    const StepStatistics& stats() const { return statistics(&dispatcher); }

    /// All points of all manifolds.
    std::vector<btManifoldPoint> points() {
        std::vector<btManifoldPoint> all;
        for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
            for (int i = 0; i < manifold->getNumContacts(); ++i) {
                all.push_back(manifold->getContactPoint(i));
            }
        }
        return all;
    }

    btDefaultCollisionConfiguration configuration;
    AnyDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};
using TestWorld = WorldWith<btCollisionDispatcher>;
using BudgetWorld = WorldWith<Dispatcher>;

/// Of all poses, bit by bit.
template <class World>
std::uint64_t hashOf(const World& world) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const auto& body : world.bodies) {
        btScalar matrix[16];
        body->getWorldTransform().getOpenGLMatrix(matrix);
        for (const btScalar value : matrix) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(static_cast<double>(value))) * 0x100000001b3U;
        }
    }
    return hash;
}

/// What a query found.
struct Collector : btCollisionWorld::ContactResultCallback {
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
        points.push_back(point);
        firsts.push_back(first->getCollisionObject());
        return 0;
    }
    [[nodiscard]] btScalar deepest() const {
        btScalar least = BT_LARGE_FLOAT;
        for (const btManifoldPoint& point : points) {
            least = btMin(least, point.getDistance());
        }
        return least;
    }
    std::vector<btManifoldPoint> points;
    std::vector<const btCollisionObject*> firsts;
};

}  // namespace grapeshot::test
