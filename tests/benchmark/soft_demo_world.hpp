// A world for scenes as Bullet's own demos of soft bodies have them, in either of its soft worlds.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletSoftBody/btDeformableLagrangianForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>

#include <memory>
#include <vector>

#include <scenes/engine.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::bench {

class SoftDemoWorld {
  public:
    /// @param deformable btDeformableMultiBodyDynamicsWorld, else btSoftRigidDynamicsWorld
    SoftDemoWorld(scenes::Engine engine, bool deformable);
    ~SoftDemoWorld();
    SoftDemoWorld(const SoftDemoWorld&) = delete;
    SoftDemoWorld& operator=(const SoftDemoWorld&) = delete;

    void setGravity(btScalar downwards);
    [[nodiscard]] btSoftBodyWorldInfo& info() { return *m_info; }
    /// Takes it over.
    btSoftBody& add(btSoftBody* body);
    /// The same with springs and gravity, as the deformable world wants them.
    btSoftBody& addDeformable(btSoftBody* body, btScalar stiffness, btScalar damping);
    void addForce(btSoftBody& body, std::unique_ptr<btDeformableLagrangianForce> force);
    /// Takes the shape over. @param mass kg; 0: static
    btRigidBody& add(btCollisionShape* shape, const btTransform& pose, btScalar mass, btScalar friction = 0.5);
    btRigidBody& add(btCollisionShape* shape, const btVector3& place, btScalar mass, btScalar friction = 0.5) {
        return add(shape, btTransform(btQuaternion::getIdentity(), place), mass, friction);
    }
    /// Static, a btBvhTriangleMeshShape with a margin of half a metre.
    void addMesh(const scenes::Mesh& mesh, const btVector3& place);
    /// A shape of a compound; lives as long as the world.
    btCollisionShape* keep(btCollisionShape* shape);
    [[nodiscard]] btSoftBody& soft(std::size_t i) { return *m_softs[i]; }

    void step();
    /// Whether all nodes are where a number says.
    [[nodiscard]] bool isFinite() const;
    /// Nodes inside of rigid bodies: of shapes without their margins, and below the meshes.
    [[nodiscard]] int nodesInside() const;
    [[nodiscard]] int nodes() const;

  private:
    scenes::Engine m_engine;
    bool m_deformable;
    btSoftBodyRigidBodyCollisionConfiguration m_configuration;
    scenes::TimedDispatcher m_dispatcher{&m_configuration};
    btDbvtBroadphase m_broadphase;
    std::unique_ptr<btSoftBodySolver> m_softSolver;
    std::unique_ptr<btConstraintSolver> m_solver;
    std::unique_ptr<btDiscreteDynamicsWorld> m_world;
    btSoftBodyWorldInfo* m_info = nullptr;
    std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
    std::vector<std::unique_ptr<scenes::Mesh>> m_meshes;
    std::vector<std::unique_ptr<btStridingMeshInterface>> m_arrays;
    std::vector<std::unique_ptr<btRigidBody>> m_rigids;
    std::vector<std::unique_ptr<btDeformableLagrangianForce>> m_forces;
    std::vector<std::unique_ptr<btSoftBody>> m_softs;
};

}  // namespace grapeshot::bench
