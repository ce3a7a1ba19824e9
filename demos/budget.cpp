// Twenty tori fall on a mesh floor, and no step may cost more than the budget.
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>
#include <algorithm>
#include <cstdio>
#include <grapeshot/plugin.hpp>
#include <vector>

int main() {
    btTriangleMesh ring, ground;  // a torus as in minimal.cpp, and two triangles
    const auto corner = [](int i, int j) {
        const btScalar u = SIMD_2_PI / 40 * btScalar(i % 40), v = SIMD_2_PI / 20 * btScalar(j % 20);
        return btVector3(4 + btCos(v), btSin(v), 0).rotate(btVector3(0, 1, 0), u) / 4;
    };
    for (int quad = 0, i = 0, j = 0; quad < 40 * 20; ++quad, i = quad / 20, j = quad % 20) {
        ring.addTriangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
        ring.addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
    ground.addTriangle({-20, 0, -20}, {-20, 0, 20}, {20, 0, 20});
    ground.addTriangle({-20, 0, -20}, {20, 0, 20}, {20, 0, -20});
    btGImpactMeshShape torus(&ring);
    torus.setMargin(btScalar(0.02));
    torus.updateBound();
    btBvhTriangleMeshShape floor(&ground, true);

    btDefaultCollisionConfiguration configuration;
    grapeshot::Dispatcher dispatcher(&configuration);  // in place of btCollisionDispatcher
    grapeshot::Settings settings;
    settings.frameBudget.work = 2000;  // work units of about 0.2 us
    settings.threads = 2;
    grapeshot::registerAlgorithms(&dispatcher, settings);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    std::vector<btRigidBody> bodies;
    bodies.reserve(21);
    bodies.emplace_back(0, nullptr, &floor);
    for (int i = 0; i < 20; ++i) {
        bodies.emplace_back(1, nullptr, &torus, grapeshot::massProperties(&torus, 1).inertia);
        bodies.back().translate({btScalar(i % 3) - 1, 1 + btScalar(i), btScalar(i % 2)});
    }
    std::for_each(bodies.begin(), bodies.end(), [&](btRigidBody& body) { world.addRigidBody(&body); });
    bool held = true;
    int cutShort = 0;
    for (int step = 0; step < 300; ++step) {
        world.stepSimulation(btScalar(1) / 60, 0);
        const grapeshot::StepStatistics& last = grapeshot::statistics(&dispatcher);
        held = held && last.work <= std::max(last.budget, last.mandatory);
        cutShort += last.degraded;
    }
    const auto fallen = std::count_if(bodies.begin() + 1, bodies.end(),
                                      [](const btRigidBody& body) { return body.getCenterOfMassPosition().y() < 0; });
    std::printf("%d pairs were cut short, %d of 20 bodies fell through the floor.\n", cutShort, int(fallen));
    return held && fallen == 0 && cutShort > 0 ? 0 : 1;
}
