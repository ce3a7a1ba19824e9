// Two concave bodies land on a plane and on each other: plain Bullet, and one line of Grapeshot.
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>
#include <cstdio>
#include <grapeshot/plugin.hpp>

int main() {
    btTriangleMesh mesh;  // a torus: ring 1 m, tube 0.25 m
    const auto corner = [](int i, int j) {
        const btScalar u = SIMD_2_PI / 40 * btScalar(i % 40), v = SIMD_2_PI / 20 * btScalar(j % 20);
        return btVector3(4 + btCos(v), btSin(v), 0).rotate(btVector3(0, 1, 0), u) / 4;
    };
    for (int quad = 0, i = 0, j = 0; quad < 40 * 20; ++quad, i = quad / 20, j = quad % 20) {
        mesh.addTriangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
        mesh.addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
    btGImpactMeshShape torus(&mesh);
    torus.setMargin(btScalar(0.02));
    torus.updateBound();
    btVector3 inertia;
    torus.calculateLocalInertia(1, inertia);
    btStaticPlaneShape plane(btVector3(0, 1, 0), 0);
    btRigidBody ground(0, nullptr, &plane), lower(1, nullptr, &torus, inertia), upper(1, nullptr, &torus, inertia);
    lower.translate(btVector3(0, 1, 0));
    upper.translate(btVector3(0, 2, 0));

    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    grapeshot::registerAlgorithms(&dispatcher);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    for (btRigidBody* body : {&ground, &lower, &upper}) {
        world.addRigidBody(body);
    }
    for (int step = 0; step < 300; ++step) {
        world.stepSimulation(btScalar(1) / 60, 0);
    }
    const double low = lower.getCenterOfMassPosition().y(), high = upper.getCenterOfMassPosition().y();
    std::printf("After 5 s the two tori rest at %.3f m and %.3f m.\n", low, high);
    return low > 0.25 && low < 0.29 && high > 0.75 && high < 0.83 ? 0 : 1;
}
