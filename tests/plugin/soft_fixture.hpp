// Worlds with soft bodies for tests, and what became of them, measured without the library.
#pragma once

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <cmath>

#include "bullet_fixture.hpp"

namespace grapeshot::test {

template <class AnyDispatcher>
class SoftWorldWith {
  public:
    /// @param ourSolver SoftBodySolver in place of Bullet's
    explicit SoftWorldWith(const Settings& settings = {}, bool registered = true, bool ourSolver = false)
        : world(&dispatcher, &broadphase, &solver, &configuration, ourSolver ? &softSolver : nullptr) {
        if (registered) {
            EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        }
        world.setGravity({0, -9.81_s, 0});
        world.getDispatchInfo().m_deterministicOverlappingPairs = true;
        btSoftBodyWorldInfo& info = world.getWorldInfo();
        info.m_broadphase = &broadphase;
        info.m_dispatcher = &dispatcher;
        info.m_gravity.setValue(0, -9.81_s, 0);
        info.m_sparsesdf.Initialize();
    }
    ~SoftWorldWith() {
        for (auto& body : softs) {
            world.removeSoftBody(body.get());
        }
        for (auto& body : bodies) {
            world.removeRigidBody(body.get());
        }
    }
    SoftWorldWith(const SoftWorldWith&) = delete;
    SoftWorldWith& operator=(const SoftWorldWith&) = delete;

    void setGravity(const btVector3& gravity) {
        world.setGravity(gravity);
        world.getWorldInfo().m_gravity = gravity;
    }
    btSoftBody& add(btSoftBody* body, btScalar margin) {
        body->getCollisionShape()->setMargin(margin);
        world.addSoftBody(body);
        softs.emplace_back(body);
        return *body;
    }
    btRigidBody& add(btCollisionShape& shape, const btTransform& pose, btScalar mass = 0) {
        bodies.push_back(rigidBody(shape, pose, mass));
        world.addRigidBody(bodies.back().get());
        return *bodies.back();
    }
    void step(int count = 1, btScalar timeStep = 1.0_s / 60) {
        for (int i = 0; i < count; ++i) {
            world.stepSimulation(timeStep, 0);
        }
    }
    const StepStatistics& stats() const { return statistics(&dispatcher); }

    btSoftBodyRigidBodyCollisionConfiguration configuration;
    AnyDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    SoftBodySolver softSolver{&dispatcher};
    btSoftRigidDynamicsWorld world;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<std::unique_ptr<btSoftBody>> softs;
};
using SoftTestWorld = SoftWorldWith<btCollisionDispatcher>;
using SoftBudgetWorld = SoftWorldWith<Dispatcher>;

/// A square cloth in the xz plane, about a centre. @param fixed corners, as CreatePatch has them
inline btSoftBody* cloth(btSoftBodyWorldInfo& info, const btVector3& center, btScalar half, int nodes, int fixed,
                         btScalar mass) {
    btSoftBody* body = btSoftBodyHelpers::CreatePatch(
        info, center + btVector3(-half, 0, -half), center + btVector3(half, 0, -half),
        center + btVector3(-half, 0, half), center + btVector3(half, 0, half), nodes, nodes, fixed, true);
    body->setTotalMass(mass);
    return body;
}

/// Nodes inside of a torus about the y axis at the origin, deeper than `depth`: by its formula, not by its mesh.
inline int nodesInTorus(const btSoftBody& body, double ring, double tube, double depth = 0) {
    int count = 0;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const btVector3& x = body.m_nodes[i].m_x;
        const double radial = std::hypot(static_cast<double>(x.x()), static_cast<double>(x.z())) - ring;
        count += std::hypot(radial, static_cast<double>(x.y())) < tube - depth ? 1 : 0;
    }
    return count;
}

/// Faces straight above a point.
inline int facesAbove(const btSoftBody& body, const btVector3& point) {
    int count = 0;
    for (int f = 0; f < body.m_faces.size(); ++f) {
        const auto& corners = body.m_faces[f].m_n;
        const btVector3 u = corners[1]->m_x - corners[0]->m_x;
        const btVector3 v = corners[2]->m_x - corners[0]->m_x;
        const btVector3 w = point - corners[0]->m_x;
        const btScalar det = u.x() * v.z() - v.x() * u.z();
        const btScalar s = (w.x() * v.z() - v.x() * w.z()) / det;
        const btScalar t = (u.x() * w.z() - w.x() * u.z()) / det;
        count += det != 0 && s >= 0 && t >= 0 && s + t <= 1 && s * u.y() + t * v.y() > w.y() ? 1 : 0;
    }
    return count;
}

inline bool isFinite(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        if (!std::isfinite(body.m_nodes[i].m_x.length2()) || !std::isfinite(body.m_nodes[i].m_v.length2())) {
            return false;
        }
    }
    return true;
}

inline double fastest(const btSoftBody& body) {
    double most = 0;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        most = std::max(most, static_cast<double>(body.m_nodes[i].m_v.length()));
    }
    return most;
}

}  // namespace grapeshot::test
