// Bodies that are no plain rigid bodies: links of multibodies, kinematic ones, ghosts, GImpact compounds.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <gmock/gmock.h>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

/// A free base and a hanging link, both with meshes, fall onto a floor.
struct Robot {
    explicit Robot(btCollisionShape& floorShape) {
        EXPECT_EQ(registerAlgorithms(&dispatcher), Status::ok);
        world.setGravity({0, -9.81_s, 0});
        floor.setCollisionShape(&floorShape);
        world.addCollisionObject(&floor, btBroadphaseProxy::StaticFilter,
                                 btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
        const MassProperties properties = massProperties(block.get(), 1);
        body.setupRevolute(0, 1, properties.inertia, -1, btQuaternion::getIdentity(), {0, 0, 1}, {0.45_s, 0, 0},
                           {0.45_s, 0, 0}, true);
        body.setBasePos({0, 1, 0});
        body.finalizeMultiDof();
        world.addMultiBody(&body);
        for (int i = 0; i < 2; ++i) {
            colliders[i] = std::make_unique<btMultiBodyLinkCollider>(&body, i - 1);
            colliders[i]->setCollisionShape(block.get());
            world.addCollisionObject(colliders[i].get(), btBroadphaseProxy::DefaultFilter,
                                     btBroadphaseProxy::AllFilter);
        }
        body.setBaseCollider(colliders[0].get());
        body.getLink(0).m_collider = colliders[1].get();
        btAlignedObjectArray<btQuaternion> turns;
        btAlignedObjectArray<btVector3> places;
        body.updateCollisionObjectWorldTransforms(turns, places);
    }
    ~Robot() {
        for (auto& collider : colliders) {
            world.removeCollisionObject(collider.get());
        }
        world.removeMultiBody(&body);
        world.removeCollisionObject(&floor);
    }
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    MeshShape block{scenes::crenelBlock({0.4F, 0.15F, 0.3F}, 3), Kind::mesh, 0.01_s};
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btMultiBodyConstraintSolver solver;
    btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    btCollisionObject floor;
    btMultiBody body{1, 1, massProperties(block.get(), 1).inertia, false, false};
    std::array<std::unique_ptr<btMultiBodyLinkCollider>, 2> colliders;
};

TEST(MultiBodies, MeshLinksRestOnMeshesPlanesAndBoxes) {
    const MeshShape mesh(scenes::moved(scenes::box({3, 0.5F, 3}, 6), {0, -0.5F, 0}), Kind::bvh, 0.01_s);
    btStaticPlaneShape plane({0, 1, 0}, 0.01_s);
    plane.setMargin(0);
    for (btCollisionShape* floor : {mesh.get(), static_cast<btCollisionShape*>(&plane)}) {
        Robot robot(*floor);
        for (int i = 0; i < 300; ++i) {
            robot.world.stepSimulation(1.0_s / 60, 0);
        }
        for (const auto& collider : robot.colliders) {
            EXPECT_NEAR(collider->getWorldTransform().getOrigin().y(), 0.17, 0.03) << floor->getName();
        }
        EXPECT_GT(statistics(&robot.dispatcher).contacts, 3) << floor->getName();
        EXPECT_LT(robot.body.getBaseVel().length(), 0.05) << floor->getName();
    }
}

TEST(Kinematic, AMeshThatIsMovedCarriesABody) {
    const MeshShape plate(scenes::box({2, 0.1F, 2}, 4), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::crenelBlock({0.4F, 0.2F, 0.3F}, 3), Kind::mesh, 0.01_s);
    TestWorld world;
    btRigidBody& lift = world.add(*plate, at({0, 0, 0}));
    lift.setCollisionFlags(lift.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    lift.setActivationState(DISABLE_DEACTIVATION);
    world.world.removeRigidBody(&lift);
    world.world.addRigidBody(&lift, btBroadphaseProxy::KinematicFilter, btBroadphaseProxy::AllFilter);
    btRigidBody& body = world.add(*block, at({0, 0.33_s, 0}), 1);
    for (int i = 0; i < 120; ++i) {
        lift.setWorldTransform(at({0, 0.005_s * btScalar(i), 0}));
        world.step();
    }
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.595 + 0.32, 0.03);
}

TEST(Ghosts, PairsOfAMeshGhostHaveContacts) {
    const MeshShape torus(scenes::torus(0.6F, 0.2F, 24, 12), Kind::mesh, 0.01_s);
    const MeshShape block(scenes::box({0.2F, 0.2F, 0.2F}, 2), Kind::bvh, 0.01_s);
    TestWorld world;
    btGhostPairCallback pairs;
    world.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&pairs);
    btPairCachingGhostObject ghost;
    ghost.setCollisionShape(torus.get());
    ghost.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
    world.world.addCollisionObject(&ghost, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter);
    btRigidBody& hit = world.add(*block, at({0.6_s, 0, 0}));
    world.add(*block, at({0, 0, 0}));
    world.step(2);
    EXPECT_EQ(ghost.getNumOverlappingObjects(), 2);
    btBroadphasePairArray& found = ghost.getOverlappingPairCache()->getOverlappingPairArray();
    world.dispatcher.dispatchAllCollisionPairs(ghost.getOverlappingPairCache(), world.world.getDispatchInfo(),
                                               &world.dispatcher);
    int touching = 0;
    for (int i = 0; i < found.size(); ++i) {
        btManifoldArray manifolds;
        if (found[i].m_algorithm != nullptr) {
            found[i].m_algorithm->getAllContactManifolds(manifolds);
        }
        int points = 0;
        for (int m = 0; m < manifolds.size(); ++m) {
            points += manifolds[m]->getNumContacts();
            EXPECT_TRUE(manifolds[m]->getBody0() == &hit || manifolds[m]->getBody1() == &hit);
        }
        touching += points > 0 ? 1 : 0;
    }
    EXPECT_EQ(touching, 1) << "the one in the hole overlaps by its box alone";
    world.world.removeCollisionObject(&ghost);
}

TEST(GImpactCompounds, RestAndFollowTheirChildren) {
    const MeshShape floor(scenes::box({3, 0.5F, 3}, 6), Kind::mesh, 0.01_s);
    btBoxShape box({0.3_s, 0.2_s, 0.3_s});
    btSphereShape ball(0.2_s);
    btGImpactCompoundShape compound;
    compound.addChildShape(at({-0.5_s, 0, 0}), &box);
    compound.addChildShape(at({0.5_s, 0, 0}), &box);
    compound.updateBound();
    TestWorld world;
    world.add(*floor, at({0, -0.51_s, 0}));
    btRigidBody& body = world.add(compound, at({0, 0.4_s, 0}), 1, {0.1_s, 0.2_s, 0.2_s});
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(180);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.2, 0.01);
    EXPECT_LT(body.getLinearVelocity().length(), 0.01);
    const int manifolds = world.dispatcher.getNumManifolds();
    EXPECT_EQ(manifolds, 2);
    // Another child where one was, then a shape that is no compound, on a live pair.
    compound.setChildTransform(0, at({-0.5_s, 0.3_s, 0}));
    compound.updateBound();
    world.step();
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 1);
    body.setCollisionShape(&ball);
    world.step(120);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.2, 0.01);
    body.setCollisionShape(&compound);
    world.step(2);
    EXPECT_EQ(world.stats().fallbacks, 0U);
}

btDiscreteDynamicsWorld* removingFrom = nullptr;
btRigidBody* removed = nullptr;

void removeNow() {
    if (removed != nullptr) {
        removingFrom->removeRigidBody(std::exchange(removed, nullptr));
    }
}

/// With a plain dispatcher; a Dispatcher's is dispatcher_test's.
TEST(Callbacks, MayRemoveABody) {
    const MeshShape floor(scenes::box({3, 0.5F, 3}, 6), Kind::bvh, 0.01_s);
    const MeshShape block(scenes::box({0.3F, 0.3F, 0.3F}, 2), Kind::mesh, 0.01_s);
    btBoxShape box({0.3_s, 0.3_s, 0.3_s});
    btGImpactCompoundShape compound;
    compound.addChildShape(at({-0.4_s, 0, 0}), &box);
    compound.addChildShape(at({0.4_s, 0, 0}), &box);
    compound.updateBound();
    for (btCollisionShape* shape : {block.get(), static_cast<btCollisionShape*>(&compound)}) {
        for (int which = 0; which < 2; ++which) {
            Settings settings;
            settings.bvhConvexPairs = true;  // so that the compound's children are ours
            TestWorld world(settings);
            world.world.getDispatchInfo().m_deterministicOverlappingPairs = false;
            world.add(*floor, at({0, -0.5_s, 0}));
            world.add(*block, at({2, 0.31_s, 2}), 1);
            btRigidBody& body = world.add(*shape, at({0, 0.305_s, 0}), 1, {0.1_s, 0.1_s, 0.1_s});
            body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
            removingFrom = &world.world;
            removed = nullptr;
            world.step(2);
            removed = &body;
            if (which == 0) {
                gContactAddedCallback = [](btManifoldPoint&, const btCollisionObjectWrapper* first, int, int,
                                           const btCollisionObjectWrapper* second, int, int) {
                    if (first->getCollisionObject() == removed || second->getCollisionObject() == removed) {
                        removeNow();
                    }
                    return true;
                };
            } else {
                gContactProcessedCallback = [](btManifoldPoint&, void* first, void* second) {
                    if (first == removed || second == removed) {
                        removeNow();
                    }
                    return true;
                };
            }
            world.step(3);
            gContactAddedCallback = nullptr;
            gContactProcessedCallback = nullptr;
            EXPECT_EQ(removed, nullptr) << which << ' ' << shape->getName();
            EXPECT_EQ(world.world.getNumCollisionObjects(), 2);
            EXPECT_GT(world.stats().contacts, 0) << "the others go on";
            world.world.addRigidBody(&body);  // for the fixture, which takes it out again
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
