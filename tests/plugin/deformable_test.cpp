// Cloth against rigid meshes and multi-bodies in btDeformableMultiBodyDynamicsWorld.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <gmock/gmock.h>

#include "soft_fixture.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

using Flags = btSoftBody::fCollision;

/// A cloth above a torus mesh.
class DeformableScene {
  public:
    explicit DeformableScene(bool multiBody, int flags = Flags::SDF_RDN | Flags::SDF_RDF | Flags::SDF_MDF) {
        EXPECT_EQ(registerAlgorithms(&m_dispatcher), Status::ok);
        m_solver.setDeformableSolver(&m_deformableSolver);
        world.setGravity({0, -9.81_s, 0});
        world.getWorldInfo().m_gravity.setValue(0, -9.81_s, 0);
        if (multiBody) {
            m_body.setBasePos({0, 0, 0});
            m_body.finalizeMultiDof();
            m_collider.setCollisionShape(m_torus.get());
            m_collider.setWorldTransform(at({0, 0, 0}));
            m_collider.setFriction(1);
            m_body.setBaseCollider(&m_collider);
            world.addMultiBody(&m_body);
            world.addCollisionObject(&m_collider, 2, 3);
        } else {
            m_rigid.setFriction(1);
            world.addRigidBody(&m_rigid);
        }
        sheet.reset(cloth(world.getWorldInfo(), {0, 0.4_s, 0}, 1.3_s, 21, 0, 1));
        sheet->getCollisionShape()->setMargin(0.02_s);
        sheet->m_cfg.collisions = Flags::SDF_RD | flags;
        sheet->m_cfg.kKHR = sheet->m_cfg.kCHR = sheet->m_cfg.kDF = 1;
        world.addSoftBody(sheet.get());
        world.addForce(sheet.get(), &m_springs);
        world.addForce(sheet.get(), &m_gravity);
    }
    ~DeformableScene() {
        world.removeForce(sheet.get(), &m_springs);
        world.removeForce(sheet.get(), &m_gravity);
        world.removeSoftBody(sheet.get());
        if (m_body.getBaseCollider() != nullptr) {
            world.removeCollisionObject(&m_collider);
            world.removeMultiBody(&m_body);
        } else {
            world.removeRigidBody(&m_rigid);
        }
    }
    DeformableScene(const DeformableScene&) = delete;
    DeformableScene& operator=(const DeformableScene&) = delete;

    void step(int count) {
        for (int i = 0; i < count; ++i) {
            world.stepSimulation(1.0_s / 240, 0, 1.0_s / 240);
        }
    }
    [[nodiscard]] const StepStatistics& stats() const { return statistics(&m_dispatcher); }

  private:
    MeshShape m_torus{scenes::torus(1, 0.3F, 48, 24), Kind::bvh, 0.005_s};
    btSoftBodyRigidBodyCollisionConfiguration m_configuration;
    btCollisionDispatcher m_dispatcher{&m_configuration};
    btDbvtBroadphase m_broadphase;
    btDeformableBodySolver m_deformableSolver;
    btDeformableMultiBodyConstraintSolver m_solver;

  public:
    btDeformableMultiBodyDynamicsWorld world{&m_dispatcher, &m_broadphase, &m_solver, &m_configuration,
                                             &m_deformableSolver};
    std::unique_ptr<btSoftBody> sheet;

  private:
    btRigidBody m_rigid{btRigidBody::btRigidBodyConstructionInfo(0, nullptr, m_torus.get())};
    btMultiBody m_body{0, 1, {1, 1, 1}, true, false};
    btMultiBodyLinkCollider m_collider{&m_body, -1};
    btDeformableMassSpringForce m_springs{10, 0.2_s, true};
    btDeformableGravityForce m_gravity{{0, -9.81_s, 0}};
};

TEST(Deformable, ClothRestsOnARigidMesh) {
    DeformableScene scene(false);
    scene.step(sampleSize(240, 2400));
    EXPECT_TRUE(isFinite(*scene.sheet));
    EXPECT_EQ(nodesInTorus(*scene.sheet, 1, 0.3, 0.01), 0);
    EXPECT_GT(scene.sheet->m_nodeRigidContacts.size(), 10);
    EXPECT_GT(scene.sheet->m_faceRigidContacts.size(), 0);
    EXPECT_EQ(scene.stats().contacts,
              scene.sheet->m_nodeRigidContacts.size() + scene.sheet->m_faceRigidContacts.size());
}

TEST(Deformable, ClothRestsOnAMultiBody) {
    DeformableScene scene(true);
    scene.step(240);
    EXPECT_TRUE(isFinite(*scene.sheet));
    EXPECT_EQ(nodesInTorus(*scene.sheet, 1, 0.3, 0.01), 0);
    EXPECT_GT(scene.sheet->m_nodeRigidContacts.size(), 10);
}

TEST(Deformable, FlagsSayWhichFeaturesCollide) {
    DeformableScene scene(false, Flags::SDF_RDN);
    scene.step(90);
    EXPECT_GT(scene.sheet->m_nodeRigidContacts.size(), 0);
    EXPECT_EQ(scene.sheet->m_faceRigidContacts.size(), 0);
}

}  // namespace
}  // namespace grapeshot::test
