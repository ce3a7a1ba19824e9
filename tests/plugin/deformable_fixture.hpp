// btDeformableMultiBodyDynamicsWorld for tests.
#pragma once

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>

#include <memory>
#include <vector>

#include "soft_fixture.hpp"

namespace grapeshot::test {

/// Meets rigid bodies by its nodes and its faces.
inline constexpr int meetsRigid =
    btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN | btSoftBody::fCollision::SDF_RDF;

template <class AnyDispatcher>
class DeformableWorldWith {
  public:
    explicit DeformableWorldWith(const Settings& settings = {}) {
        EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        m_solver.setDeformableSolver(&m_deformableSolver);
        world.setGravity({0, -9.81_s, 0});
        world.getWorldInfo().m_gravity.setValue(0, -9.81_s, 0);
        world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    }
    ~DeformableWorldWith() {
        while (!softs.empty()) {
            remove(*softs.front());
        }
        for (auto& body : bodies) {
            world.removeRigidBody(body.get());
        }
    }
    DeformableWorldWith(const DeformableWorldWith&) = delete;
    DeformableWorldWith& operator=(const DeformableWorldWith&) = delete;

    /// With springs and gravity. @param flags all of its collision flags
    btSoftBody& add(btSoftBody* body, btScalar margin, int flags) {
        body->getCollisionShape()->setMargin(margin);
        body->m_cfg.collisions = flags;
        body->m_cfg.kKHR = body->m_cfg.kCHR = 1;
        body->m_cfg.kDF = 0.5_s;
        world.addSoftBody(body);
        softs.emplace_back(body);
        world.addForce(body, &m_springs);
        world.addForce(body, &m_gravity);
        return *body;
    }
    btRigidBody& add(btCollisionShape& shape, const btTransform& pose) {
        bodies.push_back(rigidBody(shape, pose, 0));
        world.addRigidBody(bodies.back().get());
        return *bodies.back();
    }
    void remove(btSoftBody& body) {
        world.removeSoftBody(&body);
        std::erase_if(softs, [&](const auto& held) { return held.get() == &body; });
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) {
            world.stepSimulation(1.0_s / 240, 0, 1.0_s / 240);
        }
    }
    [[nodiscard]] const StepStatistics& stats() const { return statistics(&dispatcher); }

  private:
    // Of all bodies: the world keeps one force of each kind.
    btDeformableMassSpringForce m_springs{10, 0.2_s, true};
    btDeformableGravityForce m_gravity{{0, -9.81_s, 0}};
    btSoftBodyRigidBodyCollisionConfiguration m_configuration;

  public:
    AnyDispatcher dispatcher{&m_configuration};

  private:
    btDbvtBroadphase m_broadphase;
    btDeformableBodySolver m_deformableSolver;
    btDeformableMultiBodyConstraintSolver m_solver;

  public:
    btDeformableMultiBodyDynamicsWorld world{&dispatcher, &m_broadphase, &m_solver, &m_configuration,
                                             &m_deformableSolver};
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<std::unique_ptr<btSoftBody>> softs;
};
using DeformableTestWorld = DeformableWorldWith<btCollisionDispatcher>;
using DeformableBudgetWorld = DeformableWorldWith<Dispatcher>;

}  // namespace grapeshot::test
