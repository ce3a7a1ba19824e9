// GImpact meshes against planes and convex shapes, both orders, margins as Bullet means them.
#include <gmock/gmock.h>

#include <cmath>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

constexpr btScalar margin = 0.02_s;

/// Rests the mesh on the solid's top without gravity and gives the contacts, normals seen from the mesh.
struct Touch {
    Touch(const MeshShape& mesh, const btTransform& meshPose, btCollisionShape& solid, const btTransform& solidPose,
          bool meshFirst) {
        world.world.setGravity({0, 0, 0});
        if (meshFirst) {
            world.add(*mesh, meshPose, 1, {1, 1, 1});
        }
        world.add(solid, solidPose);
        if (!meshFirst) {
            world.add(*mesh, meshPose, 1, {1, 1, 1});
        }
        world.world.performDiscreteCollisionDetection();
        for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
            const bool meshIs0 = manifold.getBody0()->getCollisionShape() == mesh.get();
            for (int i = 0; i < manifold.getNumContacts(); ++i) {
                const btManifoldPoint& p = manifold.getContactPoint(i);
                distances.push_back(p.getDistance());
                normals.push_back(meshIs0 ? p.m_normalWorldOnB : -p.m_normalWorldOnB);
                onSolid.push_back(meshIs0 ? p.m_positionWorldOnB : p.m_positionWorldOnA);
                triangles.push_back(meshIs0 ? p.m_index0 : p.m_index1);
            }
        }
    }
    [[nodiscard]] btScalar deepest() const {
        return distances.empty() ? BT_LARGE_FLOAT : *std::min_element(distances.begin(), distances.end());
    }
    TestWorld world;
    std::vector<btScalar> distances;
    std::vector<btVector3> normals;
    std::vector<btVector3> onSolid;
    std::vector<int> triangles;
};

class Solids : public testing::TestWithParam<bool> {};

TEST_P(Solids, BoxOnPlane) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 4), Kind::mesh, margin);
    btStaticPlaneShape plane({0, 1, 0}, 0.3_s);
    const btTransform planePose = at({1, 2, 3}, btQuaternion({1, 0, 0}, 0.4_s));
    // The same scene for every pose of the plane.
    for (const btScalar gap : {0.01_s, -0.005_s, -0.7_s}) {
        const Touch touch(box, planePose * at({0.2_s, 0.3_s + 0.5_s + margin + gap, 0.1_s}), plane, planePose,
                          GetParam());
        ASSERT_EQ(touch.distances.size(), 4U);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(touch.distances[i], gap, 1e-5);
            EXPECT_LT(touch.normals[i].distance(planePose.getBasis().getColumn(1)), 1e-5);
            EXPECT_GE(touch.triangles[i], 0);
        }
    }
}

TEST_P(Solids, PlaneMarginCountsAsInGImpact) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh, margin);
    btStaticPlaneShape plane({0, 1, 0}, 0);
    plane.setMargin(0.03_s);
    const Touch touch(box, at({0, 0.55_s, 0}), plane, at({0, 0, 0}), GetParam());
    ASSERT_EQ(touch.distances.size(), 4U);
    EXPECT_NEAR(touch.deepest(), 0, 1e-5);
}

TEST_P(Solids, BoxOnBox) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 3), Kind::part, margin);
    btBoxShape solid({2, 0.5_s, 2});
    for (const btScalar solidMargin : {0.04_s, 0.1_s}) {  // inside its size, whatever it is
        solid.setMargin(solidMargin);
        const Touch touch(box, at({0, 1.0_s + margin - 0.004_s, 0}), solid, at({0, 0, 0}), GetParam());
        ASSERT_EQ(touch.distances.size(), 4U);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(touch.distances[i], -0.004, 1e-5);
            EXPECT_NEAR(touch.normals[i].y(), 1, 1e-5);
            EXPECT_NEAR(touch.onSolid[i].y(), 0.5, 1e-5);
        }
    }
}

TEST_P(Solids, SphereOnMesh) {
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, margin);
    btSphereShape sphere(0.4_s);
    const Touch touch(plate, at({0, 0, 0}), sphere, at({0.3_s, 0.9_s + margin - 0.01_s, 0.2_s}), GetParam());
    ASSERT_EQ(touch.distances.size(), 1U);
    EXPECT_NEAR(touch.distances[0], -0.01, 1e-5);
    EXPECT_NEAR(touch.normals[0].y(), -1, 1e-5);
}

TEST_P(Solids, CapsuleLyingOnMesh) {
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, margin);
    btCapsuleShapeX capsule(0.2_s, 1);
    const Touch touch(plate, at({0, 0, 0}), capsule, at({0.1_s, 0.7_s + margin - 0.005_s, 0.2_s}), GetParam());
    ASSERT_EQ(touch.distances.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(touch.distances[i], -0.005, 1e-5);
        EXPECT_NEAR(std::abs(touch.onSolid[i].x() - 0.1), 0.5, 1e-4);
    }
}

TEST_P(Solids, CylinderOnMesh) {
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, margin);
    btCylinderShape cylinder({0.4_s, 0.3_s, 0.4_s});
    const Touch touch(plate, at({0, 0, 0}), cylinder, at({0.1_s, 0.8_s + margin - 0.005_s, 0.2_s}), GetParam());
    ASSERT_FALSE(touch.distances.empty());
    EXPECT_NEAR(touch.deepest(), -0.005, 2e-3);
    for (const btVector3& normal : touch.normals) {
        EXPECT_NEAR(normal.y(), -1, 0.02);
    }
}

TEST_P(Solids, HullsMarginIsAroundIt) {
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, margin);
    btConvexHullShape hull;
    for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7}) {
        hull.addPoint({(corner & 1) != 0 ? 0.5_s : -0.5_s, (corner & 2) != 0 ? 0.5_s : -0.5_s,
                       (corner & 4) != 0 ? 0.5_s : -0.5_s});
    }
    hull.setMargin(0.04_s);
    const Touch touch(plate, at({0, 0, 0}), hull, at({0.1_s, 1.0_s + margin + 0.04_s - 0.005_s, 0.2_s}), GetParam());
    ASSERT_GE(touch.distances.size(), 4U);
    EXPECT_NEAR(touch.deepest(), -0.005, 1e-3);
    btVector3 least(9, 9, 9);
    btVector3 most(-9, -9, -9);
    for (std::size_t i = 0; i < touch.distances.size(); ++i) {
        EXPECT_NEAR(touch.normals[i].y(), -1, 0.02);
        least.setMin(touch.onSolid[i]);
        most.setMax(touch.onSolid[i]);
    }
    // Spread over the face, not one corner.
    EXPECT_GT(most.x() - least.x(), 0.8);
    EXPECT_GT(most.z() - least.z(), 0.8);
}

TEST_P(Solids, BuriedBodiesArePushedOut) {
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, margin);
    btBoxShape box({0.2_s, 0.2_s, 0.2_s});
    btSphereShape sphere(0.2_s);
    btCylinderShape cylinder({0.2_s, 0.2_s, 0.2_s});
    for (btCollisionShape* solid : {static_cast<btCollisionShape*>(&box), static_cast<btCollisionShape*>(&sphere),
                                    static_cast<btCollisionShape*>(&cylinder)}) {
        const Touch touch(plate, at({0, 0, 0}), *solid, at({0.31_s, 0.25_s, 0.27_s}), GetParam());
        ASSERT_FALSE(touch.distances.empty()) << solid->getName();
        const auto deepest = static_cast<std::size_t>(std::min_element(touch.distances.begin(), touch.distances.end()) -
                                                      touch.distances.begin());
        EXPECT_LT(touch.distances[deepest], -0.3) << solid->getName();
        EXPECT_LT(touch.normals[deepest].y(), -0.9) << solid->getName();
    }
}

INSTANTIATE_TEST_SUITE_P(BothOrders, Solids, testing::Bool(),
                         [](const auto& sample) { return sample.param ? "MeshFirst" : "SolidFirst"; });

TEST(SolidScenes, MeshBodiesRestOnEverySolid) {
    btStaticPlaneShape plane({0, 1, 0}, 0);
    btBoxShape box({3, 0.5_s, 3});
    btCylinderShape cylinder({3, 0.5_s, 3});
    btConvexHullShape hull;
    for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7}) {
        hull.addPoint({(corner & 1) != 0 ? 3.0_s : -3.0_s, (corner & 2) != 0 ? 0.5_s : -0.5_s,
                       (corner & 4) != 0 ? 3.0_s : -3.0_s});
    }
    struct Case {
        btCollisionShape* solid;
        btScalar top;
    };
    for (const Case& item :
         {Case{&plane, 0}, Case{&box, 0.5_s}, Case{&cylinder, 0.5_s}, Case{&hull, 0.5_s + hull.getMargin()}}) {
        const MeshShape mesh(scenes::crenelBlock({0.5F, 0.3F, 0.4F}, 3), Kind::mesh, margin);
        btVector3 lower;
        btVector3 upper;
        mesh.get()->getAabb(btTransform::getIdentity(), lower, upper);
        TestWorld world;
        world.add(*item.solid, at({0, 0, 0}));
        btRigidBody& body = world.add(*mesh, at({0, item.top - lower.y() + 0.1_s, 0}), 1);
        body.setActivationState(DISABLE_DEACTIVATION);
        world.step(180);
        const btVector3& place = body.getWorldTransform().getOrigin();
        EXPECT_NEAR(place.y() + lower.y(), item.top, 0.015) << item.solid->getName();
        EXPECT_LT(body.getLinearVelocity().length(), 0.02) << item.solid->getName();
        EXPECT_LT(body.getAngularVelocity().length(), 0.05) << item.solid->getName();
        EXPECT_GT(body.getWorldTransform().getBasis()[1][1], 0.999) << item.solid->getName();
    }
}

}  // namespace
}  // namespace grapeshot::test
