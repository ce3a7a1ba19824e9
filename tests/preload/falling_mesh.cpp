// A Bullet program that knows nothing of Grapeshot: a ring of triangles falls on a larger one that does not move.
// Bullet has no algorithm for the two unless GImpact is registered. Prints where the ring is after four seconds, and
// how many manifolds had contacts then. usage: falling_mesh [--gimpact] [--derived] [--leak]
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

namespace {

void addRing(btTriangleMesh& mesh, btScalar radius, btScalar tube) {
    constexpr int around = 24;
    constexpr int across = 12;
    const auto corner = [&](int i, int j) {
        const btScalar u = SIMD_2_PI * btScalar(i % around) / around;
        const btScalar v = SIMD_2_PI * btScalar(j % across) / across;
        const btScalar r = radius + tube * btCos(v);
        return btVector3(r * btCos(u), tube * btSin(v), r * btSin(u));
    };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            mesh.addTriangle(corner(i, j), corner(i, j + 1), corner(i + 1, j));
            mesh.addTriangle(corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1));
        }
    }
}

class OwnDispatcher : public btCollisionDispatcher {
  public:
    using btCollisionDispatcher::btCollisionDispatcher;
};

bool has(int argc, char** argv, const char* flag) {
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], flag) == 0) {
            return true;
        }
    }
    return false;
}

}  // namespace

extern "C" int fallingMesh(int argc, char** argv) {
    btDefaultCollisionConfiguration configuration;
    std::unique_ptr<btCollisionDispatcher> dispatcher(
        has(argc, argv, "--derived") ? new OwnDispatcher(&configuration) : new btCollisionDispatcher(&configuration));
    if (has(argc, argv, "--gimpact")) {
        btGImpactCollisionAlgorithm::registerAlgorithm(dispatcher.get());
    }
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(dispatcher.get(), &broadphase, &solver, &configuration);

    btTriangleMesh floorMesh;
    addRing(floorMesh, 2, btScalar(0.8));
    btBvhTriangleMeshShape floorShape(&floorMesh, true);
    btRigidBody floor(0, nullptr, &floorShape);
    world.addRigidBody(&floor);

    btTriangleMesh ringMesh;
    addRing(ringMesh, 2, btScalar(0.4));
    btGImpactMeshShape ringShape(&ringMesh);
    ringShape.updateBound();
    btDefaultMotionState start(btTransform(btQuaternion::getIdentity(), btVector3(0, 2, 0)));
    btRigidBody ring(1, &start, &ringShape, btVector3(1, 1, 1));
    world.addRigidBody(&ring);

    for (int i = 0; i < 240; ++i) {
        world.stepSimulation(btScalar(1) / 60, 0);
    }
    int manifolds = 0;
    for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
        manifolds += dispatcher->getManifoldByIndexInternal(i)->getNumContacts() > 0 ? 1 : 0;
    }
    std::printf("y %.3f manifolds %d\n", double(ring.getWorldTransform().getOrigin().y()), manifolds);
    world.removeRigidBody(&ring);
    world.removeRigidBody(&floor);
    if (has(argc, argv, "--leak")) {
        static_cast<void>(dispatcher.release());
    }
    return 0;
}
