// From a program that has a problem to one that can be rewound: what helps on the way.
#include <btBulletDynamicsCommon.h>
#include <cstddef>
#include <cstdio>
#include <grapeshot/plugin.hpp>
#include <vector>

struct Counter : btIDebugDraw {  // a renderer of yours
    int contacts = 0, boxes = 0;
    void drawLine(const btVector3&, const btVector3&, const btVector3&) override {}
    void drawBox(const btVector3&, const btVector3&, const btTransform&, const btVector3&) override { ++boxes; }
    void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override { ++contacts; }
    void reportErrorWarning(const char*) override {}
    void draw3dText(const btVector3&, const char*) override {}
    void setDebugMode(int) override {}
    int getDebugMode() const override { return DBG_DrawAabb | DBG_DrawContactPoints; }
};

int main() {
    btTriangleMesh ground, tent;  // two triangles; four on a square
    ground.addTriangle({-5, 0, -5}, {-5, 0, 5}, {5, 0, 5});
    ground.addTriangle({-5, 0, -5}, {5, 0, 5}, {5, 0, -5});
    const btVector3 top(0, 1, 0), corners[] = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    for (int i = 0; i < 4; ++i) {
        tent.addTriangle(top, corners[i], corners[(i + 1) % 4]);
    }
    tent.addTriangle(corners[0], corners[2], corners[1]);
    tent.addTriangle(corners[0], corners[3], corners[2]);
    btBvhTriangleMeshShape floor(&ground, true), pyramid(&tent, true);
    pyramid.setMargin(btScalar(0.02));
    btRigidBody below(0, nullptr, &floor), above(1, nullptr, &pyramid, grapeshot::massProperties(&pyramid, 1).inertia);
    above.translate({0, btScalar(0.1), 0});

    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.addRigidBody(&below);
    world.addRigidBody(&above);

    // 1. What is wrong? "error: noAlgorithm (bodies 0 and 1): ..."
    const grapeshot::Diagnosis before = grapeshot::diagnose(&world);
    std::printf("%s", grapeshot::toText(before).c_str());

    // 2. What would change? Nothing does yet: the shadow only looks.
    grapeshot::Shadow shadow;
    for (int step = 0; step < 15; ++step) {
        world.stepSimulation(btScalar(1) / 60, 0);
        shadow.observe(&world);
    }
    std::printf("%s", grapeshot::toText(shadow.totals()).c_str());

    // 3. Switch, and look at it.
    grapeshot::registerAlgorithms(&dispatcher);
    above.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, 2, 0}));
    broadphase.getOverlappingPairCache()->cleanProxyFromPairs(above.getBroadphaseHandle(), &dispatcher);
    Counter drawer;
    std::vector<std::byte> saved;
    for (int step = 0; step < 120; ++step) {
        world.stepSimulation(btScalar(1) / 60, 0);
        if (step == 60) {
            grapeshot::saveState(&world, saved);  // 4. For a replay, or to rewind
        }
    }
    grapeshot::debugDraw(&world, &drawer);
    const btVector3 there = above.getCenterOfMassPosition();
    grapeshot::restoreState(&world, saved);
    for (int step = 0; step < 59; ++step) {
        world.stepSimulation(btScalar(1) / 60, 0);
    }
    const bool same = there == above.getCenterOfMassPosition();
    std::printf("%d contacts, %d boxes drawn; once more from step 60: %s\n", drawer.contacts, drawer.boxes,
                same ? "the same" : "different");
    return !before.findings.empty() && shadow.totals().onlyOurs > 0 && drawer.contacts > 0 && same ? 0 : 1;
}
