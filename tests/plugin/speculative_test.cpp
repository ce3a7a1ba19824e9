// Contacts ahead of time: fast bodies and thin walls.
#include <gmock/gmock.h>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

constexpr btScalar speed = 60;  // m/s: a metre a step

/// A box is shot at a wall of 4 cm. Returns where it is after a second.
btVector3 shoot(bool speculative, btCollisionShape& bullet, btCollisionShape& wall, const btVector3& spin = {0, 0, 0},
                int* ahead = nullptr) {
    Settings settings;
    settings.speculative = speculative;
    TestWorld world(settings);
    world.world.setGravity({0, 0, 0});
    world.add(wall, at({0, 0, 0}));
    btRigidBody& body = world.add(bullet, at({-3.5_s, 0.1_s, 0.05_s}), 1);
    body.setLinearVelocity({speed, 0, 0});
    body.setAngularVelocity(spin);
    for (int i = 0; i < 60; ++i) {
        world.step();
        if (ahead != nullptr) {
            *ahead += world.stats().speculative;
        }
    }
    return body.getWorldTransform().getOrigin();
}

TEST(Speculative, AFastMeshIsStoppedByAThinMeshWall) {
    const MeshShape bullet(scenes::box({0.2F, 0.2F, 0.2F}), Kind::mesh, 0.005_s);
    const MeshShape wall(scenes::box({0.02F, 2, 2}, 4), Kind::bvh, 0.005_s);
    int ahead = 0;
    EXPECT_GT(shoot(false, *bullet, *wall).x(), 10) << "the scene does not need it";
    EXPECT_LT(shoot(true, *bullet, *wall, {0, 0, 0}, &ahead).x(), 0);
    EXPECT_GT(ahead, 0);
}

TEST(Speculative, AlsoBySheetsBySolidsAndWhileSpinning) {
    const MeshShape bullet(scenes::bumpySphere(0.2F, 0.03F, 5, 5), Kind::mesh, 0.005_s);
    scenes::Mesh upright = scenes::grid(2, 2, 4, 4);
    for (Eigen::Vector3f& v : upright.vertices) {
        v = {-v.y(), v.x(), v.z()};
    }
    const MeshShape sheet(upright, Kind::bvh, 0.005_s);
    btBoxShape solid({0.02_s, 2, 2});
    const MeshShape wall(scenes::box({0.02F, 2, 2}, 4), Kind::mesh, 0.005_s);
    for (btCollisionShape* target : {sheet.get(), static_cast<btCollisionShape*>(&solid), wall.get()}) {
        for (const btVector3& spin : {btVector3(0, 0, 0), btVector3(0, 0, 20)}) {
            EXPECT_LT(shoot(true, *bullet, *target, spin).x(), 0) << target->getName() << ' ' << spin.z();
        }
    }
}

TEST(Speculative, ThinPlatesWithThickMarginsAndSheetsDoNotPassEachOther) {
    scenes::Mesh upright = scenes::grid(0.3F, 0.3F, 3, 3);
    for (Eigen::Vector3f& v : upright.vertices) {
        v = {-v.y(), v.x(), v.z()};
    }
    const MeshShape plate(scenes::box({0.005F, 0.3F, 0.3F}, 3), Kind::mesh, 0.04_s);
    const MeshShape wall(scenes::box({0.005F, 2, 2}, 4), Kind::bvh, 0.04_s);
    const MeshShape sheet(upright, Kind::bvh, 0.04_s);
    EXPECT_LT(shoot(true, *plate, *wall).x(), 0);
    TestWorld world;
    world.world.setGravity({0, 0, 0});
    world.add(*wall, at({0, 0, 0}));
    btRigidBody& body = world.add(*sheet, at({-3.5_s, 0.1_s, 0.05_s}), 1, {0.1_s, 0.1_s, 0.1_s});
    body.setLinearVelocity({speed, 0, 0});
    world.step(60);
    EXPECT_LT(body.getWorldTransform().getOrigin().x(), 0);
}

TEST(Speculative, WhatFliesPastIsNotTouched) {
    // Along a wall at a distance of 5 cm, past its end, faster than its own size in a step.
    const MeshShape bullet(scenes::box({0.2F, 0.2F, 0.2F}), Kind::mesh, 0.005_s);
    const MeshShape wall(scenes::box({2, 0.02F, 2}, 4), Kind::bvh, 0.005_s);
    TestWorld world;
    world.world.setGravity({0, 0, 0});
    world.add(*wall, at({0, 0, 0}));
    btRigidBody& body = world.add(*bullet, at({-3.5_s, 0.28_s, 0}), 1);
    body.setLinearVelocity({speed, 0, 0});
    for (int i = 0; i < 20; ++i) {
        world.step();
        EXPECT_TRUE(world.points().empty());
    }
    EXPECT_EQ(body.getLinearVelocity().x(), speed);
    EXPECT_EQ(body.getAngularVelocity().length(), 0);
    EXPECT_GT(body.getWorldTransform().getOrigin().x(), 10);
}

TEST(Speculative, SlowBodiesCauseNone) {
    const MeshShape box(scenes::box({0.3F, 0.3F, 0.3F}), Kind::mesh);
    TestWorld world;
    world.add(*box, at({0, 0, 0}));
    world.add(*box, at({0, 1.0_s, 0}), 1);
    int ahead = 0;
    for (int i = 0; i < 60; ++i) {
        world.step();
        ahead += world.stats().speculative;
    }
    EXPECT_EQ(ahead, 0);
    EXPECT_GT(world.stats().contacts, 0);
}

TEST(Speculative, TimeStepOfZeroIsNoTrouble) {
    const MeshShape bullet(scenes::box({0.2F, 0.2F, 0.2F}), Kind::mesh);
    const MeshShape wall(scenes::box({0.02F, 2, 2}), Kind::bvh);
    TestWorld world;
    world.add(*wall, at({0, 0, 0}));
    btRigidBody& body = world.add(*bullet, at({-0.5_s, 0, 0}), 1);
    body.setLinearVelocity({speed, 0, 0});
    for (const btScalar timeStep : {0.0_s, -1.0_s}) {
        world.world.getDispatchInfo().m_timeStep = timeStep;
        world.world.performDiscreteCollisionDetection();
        EXPECT_TRUE(world.points().empty());
    }
}

}  // namespace
}  // namespace grapeshot::test
