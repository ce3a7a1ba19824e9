// Shots at a thin wall with what is no body of its own: children of compounds, links of multibodies.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>
#include <functional>

#include "gate_shots.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

constexpr btScalar shotStep = 1.0_s / 60;

/// How a shot flies along +x.
struct Flight {
    btVector3 from;
    btQuaternion turn;
    btVector3 velocity, spin;
    [[nodiscard]] int steps() const {
        return static_cast<int>(std::ceil((-2 * from.x() + 1) / (velocity.x() * shotStep)));
    }
};

Flight anyFlight(ShotRandom& random, bool tumbling) {
    const btScalar speed = random.uniform(5, 200);
    Flight flight;
    flight.from = {random.uniform(-4, -1), random.uniform(-1, 1), random.uniform(-1, 1)};
    flight.velocity = {speed, random.uniform(-0.1, 0.1) * speed, random.uniform(-0.1, 0.1) * speed};
    flight.spin = {random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    flight.turn = anyTurn(random);
    if (!tumbling) {
        flight.velocity = {speed, 0, 0};
        flight.spin = {0, 0, 0};
        flight.turn = btQuaternion::getIdentity();
    }
    return flight;
}

/// How many of so many shots end beyond the wall, of those that `shoot` gives the end's place along x of.
std::size_t through(bool tumbling, std::size_t shots, std::uint64_t seed,
                    const std::function<btScalar(const Flight&, std::size_t)>& shoot) {
    ShotRandom random(seed);
    std::size_t count = 0;
    for (std::size_t i = 0; i < shots; ++i) {
        count += shoot(anyFlight(random, tumbling), i) > btScalar(halfWall) ? 1 : 0;
    }
    return count;
}

/// A body of two plates or boxes 70 cm apart, the second within a compound of its own.
struct Dumbbell {
    explicit Dumbbell(btCollisionShape& end) {
        inner.addChildShape(at({0, 0.1_s, 0}), &end);
        whole.addChildShape(at({0, -0.35_s, 0}), &end);
        whole.addChildShape(at({0, 0.25_s, 0}, btQuaternion({1, 0, 0}, 0.5_s)), &inner);
    }
    btCompoundShape inner, whole;
};

btScalar shootRigid(btCollisionShape& bullet, btCollisionShape& wall, const Flight& flight, bool wallFirst) {
    TestWorld world;
    world.world.setGravity({0, 0, 0});
    if (wallFirst) {
        world.add(wall, at({0, 0, 0}));
    }
    btRigidBody& body = world.add(bullet, at(flight.from, flight.turn), 1, {0.1_s, 0.1_s, 0.1_s});
    if (!wallFirst) {
        world.add(wall, at({0, 0, 0}));
    }
    body.setLinearVelocity(flight.velocity);
    body.setAngularVelocity(flight.spin);
    world.step(flight.steps());
    return body.getWorldTransform().getOrigin().x();
}

TEST(ShotsOfParts, ChildrenOfCompoundsDoNotGoThrough) {
    const Bullets bullets;
    const MeshShape wall(wallMesh(false), Kind::bvh, shotMargin);
    Dumbbell plates(*bullets.plate);
    Dumbbell boxes(*bullets.box);
    const std::size_t shots = sampleSize(40, 1000);
    for (const bool tumbling : {false, true}) {
        for (Dumbbell* dumbbell : {&plates, &boxes}) {
            EXPECT_EQ(through(tumbling, shots, 21,
                              [&](const Flight& flight, std::size_t i) {
                                  return shootRigid(dumbbell->whole, *wall, flight, i % 2 == 0);
                              }),
                      0U)
                << (dumbbell == &plates ? "plates" : "boxes") << (tumbling ? ", tumbling" : "");
        }
    }
}

TEST(ShotsOfParts, AWallInACompoundStopsMeshesAndCompounds) {
    const Bullets bullets;
    const MeshShape mesh(wallMesh(false), Kind::bvh, shotMargin);
    Dumbbell plates(*bullets.plate);
    btCompoundShape wall;
    wall.addChildShape(at({0, 0, 0}), mesh.get());
    const std::size_t shots = sampleSize(30, 500);
    for (btCollisionShape* bullet : {bullets.plate.get(), static_cast<btCollisionShape*>(&plates.whole)}) {
        EXPECT_EQ(
            through(false, shots, 22,
                    [&](const Flight& flight, std::size_t i) { return shootRigid(*bullet, wall, flight, i % 2 == 0); }),
            0U)
            << bullet->getName();
    }
}

TEST(ShotsOfParts, CompoundsThatPassByAreLeftAlone) {
    const Bullets bullets;
    const MeshShape wall(wallMesh(false), Kind::bvh, shotMargin);
    Dumbbell plates(*bullets.plate);
    ShotRandom random(23);
    for (std::size_t i = 0; i < sampleSize(20, 300); ++i) {
        Flight flight = anyFlight(random, false);
        // Farther than the breaking threshold, which goes by the size of the whole compound.
        flight.from.setY(2 + 0.35_s + 0.2_s + 2 * shotMargin + 0.02_s);
        TestWorld world;
        world.world.setGravity({0, 0, 0});
        world.add(*wall, at({0, 0, 0}));
        btRigidBody& body = world.add(plates.whole, at(flight.from), 1, {0.1_s, 0.1_s, 0.1_s});
        body.setLinearVelocity(flight.velocity);
        world.step(flight.steps());
        EXPECT_EQ(body.getLinearVelocity().y(), 0) << i;
        EXPECT_EQ(body.getAngularVelocity().length(), 0) << i;
        EXPECT_GT(body.getWorldTransform().getOrigin().x(), 0.5) << i;
    }
}

/// A base and a link 70 cm from it, hinged, each with the same mesh.
struct FlyingRobot {
    FlyingRobot(btCollisionShape& shape, btCollisionShape& wallShape, const Flight& flight, bool hinged) {
        EXPECT_EQ(registerAlgorithms(&dispatcher), Status::ok);
        world.setGravity({0, 0, 0});
        wall.setCollisionShape(&wallShape);
        world.addCollisionObject(&wall, btBroadphaseProxy::StaticFilter,
                                 btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
        const btVector3 inertia = massProperties(&shape, 1).inertia;
        if (hinged) {
            body.setupRevolute(0, 1, inertia, -1, btQuaternion::getIdentity(), {0, 0, 1}, {0, 0.35_s, 0},
                               {0, 0.35_s, 0}, true);
        } else {
            body.setupFixed(0, 1, inertia, -1, btQuaternion::getIdentity(), {0, 0.35_s, 0}, {0, 0.35_s, 0}, true);
        }
        body.setBasePos(flight.from);
        body.setWorldToBaseRot(flight.turn.inverse());
        body.finalizeMultiDof();
        body.setLinearDamping(0);
        body.setAngularDamping(0);
        body.setBaseVel(flight.velocity);
        body.setBaseOmega(flight.spin);
        body.setCanSleep(false);
        world.addMultiBody(&body);
        for (int i = 0; i < 2; ++i) {
            colliders[i] = std::make_unique<btMultiBodyLinkCollider>(&body, i - 1);
            colliders[i]->setCollisionShape(&shape);
            world.addCollisionObject(colliders[i].get(), btBroadphaseProxy::DefaultFilter,
                                     btBroadphaseProxy::AllFilter);
        }
        body.setBaseCollider(colliders[0].get());
        body.getLink(0).m_collider = colliders[1].get();
        btAlignedObjectArray<btQuaternion> turns;
        btAlignedObjectArray<btVector3> places;
        body.forwardKinematics(turns, places);
        body.updateCollisionObjectWorldTransforms(turns, places);
    }
    ~FlyingRobot() {
        for (auto& collider : colliders) {
            world.removeCollisionObject(collider.get());
        }
        world.removeMultiBody(&body);
        world.removeCollisionObject(&wall);
    }
    FlyingRobot(const FlyingRobot&) = delete;
    FlyingRobot& operator=(const FlyingRobot&) = delete;

    [[nodiscard]] btScalar farthest() const {
        return btMax(colliders[0]->getWorldTransform().getOrigin().x(),
                     colliders[1]->getWorldTransform().getOrigin().x());
    }

    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btMultiBodyConstraintSolver solver;
    SweptMultiBodyWorld world{&dispatcher, &broadphase, &solver, &configuration};
    btCollisionObject wall;
    btMultiBody body{1, 1, {0.01_s, 0.01_s, 0.01_s}, false, false};
    std::array<std::unique_ptr<btMultiBodyLinkCollider>, 2> colliders;
};

TEST(ShotsOfParts, LinksDoNotGoThrough) {
    const Bullets bullets;
    const MeshShape wall(wallMesh(false), Kind::bvh, shotMargin);
    const std::size_t shots = sampleSize(40, 1000);
    for (const bool hinged : {false, true}) {
        for (btCollisionShape* bullet : {bullets.plate.get(), bullets.box.get()}) {
            EXPECT_EQ(through(false, shots, 24,
                              [&](const Flight& flight, std::size_t) {
                                  FlyingRobot robot(*bullet, *wall, flight, hinged);
                                  for (int i = 0; i < flight.steps(); ++i) {
                                      robot.world.stepSimulation(shotStep, 0);
                                  }
                                  return robot.farthest();
                              }),
                      0U)
                << (hinged ? "hinged, " : "fixed, ") << (bullet == bullets.box.get() ? "boxes" : "plates");
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
