// Cloth against rigid meshes and multi-bodies in btDeformableMultiBodyDynamicsWorld.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <gmock/gmock.h>

#include "deformable_fixture.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

using Flags = btSoftBody::fCollision;

/// A cloth above a torus mesh.
class DeformableScene {
  public:
    explicit DeformableScene(bool multiBody, int flags = meetsRigid | Flags::SDF_MDF) {
        if (multiBody) {
            m_body.setBasePos({0, 0, 0});
            m_body.finalizeMultiDof();
            m_collider.setCollisionShape(m_torus.get());
            m_collider.setWorldTransform(at({0, 0, 0}));
            m_collider.setFriction(1);
            m_body.setBaseCollider(&m_collider);
            m_world.world.addMultiBody(&m_body);
            m_world.world.addCollisionObject(&m_collider, 2, 3);
        } else {
            m_world.add(*m_torus, at({0, 0, 0})).setFriction(1);
        }
        sheet = &m_world.add(cloth(m_world.world.getWorldInfo(), {0, 0.4_s, 0}, 1.3_s, 21, 0, 1), 0.02_s, flags);
        sheet->m_cfg.kDF = 1;
    }
    ~DeformableScene() {
        if (m_body.getBaseCollider() != nullptr) {
            m_world.world.removeCollisionObject(&m_collider);
            m_world.world.removeMultiBody(&m_body);
        }
    }
    DeformableScene(const DeformableScene&) = delete;
    DeformableScene& operator=(const DeformableScene&) = delete;

    void step(int count) { m_world.step(count); }
    [[nodiscard]] const StepStatistics& stats() const { return m_world.stats(); }

    btSoftBody* sheet = nullptr;

  private:
    MeshShape m_torus{scenes::torus(1, 0.3F, 48, 24), Kind::bvh, 0.005_s};
    btMultiBody m_body{0, 1, {1, 1, 1}, true, false};
    btMultiBodyLinkCollider m_collider{&m_body, -1};
    DeformableTestWorld m_world;
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
    DeformableScene scene(false, Flags::SDF_RD | Flags::SDF_RDN);
    scene.step(90);
    EXPECT_GT(scene.sheet->m_nodeRigidContacts.size(), 0);
    EXPECT_EQ(scene.sheet->m_faceRigidContacts.size(), 0);
}

}  // namespace
}  // namespace grapeshot::test
