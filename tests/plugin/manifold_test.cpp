// How contacts persist in Bullet's manifolds.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include <grapeshot/plugin/detail/point_insertion.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

TEST(Manifolds, ARestingBodyKeepsItsManifoldsAndImpulses) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::mesh);
    TestWorld world;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0.1_s, 1.02_s, 0.1_s}), 2);
    upper.setActivationState(DISABLE_DEACTIVATION);
    world.step(30);
    std::set<const btPersistentManifold*> before;
    for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
        before.insert(world.dispatcher.getManifoldByIndexInternal(m));
    }
    ASSERT_FALSE(before.empty());
    for (int i = 0; i < 120; ++i) {
        world.step();
        std::set<const btPersistentManifold*> now;
        double support = 0;
        int points = 0;
        for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold* manifold = world.dispatcher.getManifoldByIndexInternal(m);
            now.insert(manifold);
            for (int p = 0; p < manifold->getNumContacts(); ++p) {
                // As old as the scene: it was never made anew.
                EXPECT_GT(manifold->getContactPoint(p).getLifeTime(), i + 20);
                support += manifold->getContactPoint(p).m_appliedImpulse;
                ++points;
            }
        }
        EXPECT_EQ(now, before);
        EXPECT_EQ(points, 4);
        EXPECT_NEAR(support, 2 * 9.81 / 60, 0.02 * 2 * 9.81 / 60);
    }
    EXPECT_LT(upper.getLinearVelocity().length(), 1e-3);
}

int started = 0;
int ended = 0;

TEST(Manifolds, AContactStartsAndEndsOnce) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    started = ended = 0;
    gContactStartedCallback = [](btPersistentManifold* const&) { ++started; };
    gContactEndedCallback = [](btPersistentManifold* const&) { ++ended; };
    {
        TestWorld world;
        world.add(*box, at({0, 0, 0}));
        btRigidBody& upper = world.add(*box, at({0.1_s, 1.02_s, 0}), 1);
        upper.setActivationState(DISABLE_DEACTIVATION);
        world.step(60);
        const int manifolds = world.dispatcher.getNumManifolds();
        EXPECT_GT(manifolds, 0);
        EXPECT_EQ(started, manifolds);
        EXPECT_EQ(ended, 0);
        upper.setLinearVelocity({0, 10, 0});
        world.step(5);
        EXPECT_EQ(ended, started);
        EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
    }
    gContactStartedCallback = nullptr;
    gContactEndedCallback = nullptr;
}

TEST(Manifolds, SeveralForAUOnABar) {
    // Upside down over the bar, touching with its bridge and both legs.
    const MeshShape bar(scenes::box({2, 0.25F, 0.25F}, 3), Kind::mesh, 0.02_s);
    const MeshShape u(scenes::uBody(1.2F, 1.0F, 0.3F, 0.6F, 2), Kind::mesh, 0.02_s);
    TestWorld world;
    world.add(*bar, at({0, 0, 0}));
    btRigidBody& body = world.add(*u, at({0, 0.1_s, 0}, btQuaternion({0, 1, 0}, SIMD_HALF_PI)), 1);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(240);
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 3);
    std::set<std::pair<int, bool>> directions;
    for (const btManifoldPoint& point : world.points()) {
        const int axis = point.m_normalWorldOnB.absolute().maxAxis();
        directions.insert({axis, point.m_normalWorldOnB[axis] > 0});
    }
    EXPECT_EQ(directions.size(), 3U);
    EXPECT_NEAR(body.getWorldTransform().getOrigin().y(), 0.25 + 0.04 - 0.35, 0.005);
    EXPECT_LT(body.getLinearVelocity().length(), 0.001);
}

TEST(Manifolds, MaxManifoldsIsKept) {
    // A box between the legs of a U: it touches both legs and the bridge.
    const MeshShape u(scenes::uBody(1.1F, 1.0F, 0.3F, 0.6F, 2), Kind::mesh, 0.01_s);
    const MeshShape box(scenes::box({0.24F, 0.2F, 0.2F}, 2), Kind::mesh, 0.01_s);
    for (const int most : {8, 2}) {
        Settings settings;
        settings.maxManifolds = most;
        TestWorld world(settings);
        world.add(*u, at({0, 0, 0}));
        world.add(*box, at({0, 0.35_s - 0.22_s, 0}), 1);
        world.world.performDiscreteCollisionDetection();
        EXPECT_EQ(world.dispatcher.getNumManifolds(), std::min(most, 3));
        EXPECT_EQ(world.stats().droppedRegions, most == 2 ? 1U : 0U);
    }
}

TEST(Manifolds, ASharedManifoldTakesAllPointsAndNoOtherIsMade) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    TestWorld world;
    btRigidBody& lower = world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.01_s, 0}), 1);
    for (const bool swapped : {false, true}) {
        btPersistentManifold* shared = world.dispatcher.getNewManifold(&lower, &upper);
        btCollisionObjectWrapper a(nullptr, box.get(), &lower, lower.getWorldTransform(), -1, -1);
        btCollisionObjectWrapper b(nullptr, box.get(), &upper, upper.getWorldTransform(), -1, -1);
        const btCollisionObjectWrapper& first = swapped ? b : a;
        const btCollisionObjectWrapper& second = swapped ? a : b;
        btManifoldResult result(&first, &second);
        btCollisionAlgorithm* algorithm =
            world.dispatcher.findAlgorithm(&first, &second, shared, BT_CONTACT_POINT_ALGORITHMS);
        algorithm->processCollision(&first, &second, world.world.getDispatchInfo(), &result);
        algorithm->~btCollisionAlgorithm();
        world.dispatcher.freeCollisionAlgorithm(algorithm);
        EXPECT_EQ(world.dispatcher.getNumManifolds(), 1);
        ASSERT_EQ(shared->getNumContacts(), 4);
        for (int i = 0; i < 4; ++i) {
            // Body 0 is the lower one, whoever came first.
            EXPECT_NEAR(shared->getContactPoint(i).m_normalWorldOnB.y(), -1, 1e-5);
            EXPECT_NEAR(shared->getContactPoint(i).m_localPointA.y(), 0.51, 1e-5);
            EXPECT_NEAR(shared->getContactPoint(i).getDistance(), -0.01, 1e-5);
        }
        world.dispatcher.releaseManifold(shared);
    }
}

/// A manifold on its own, with points of our choice.
struct Insertion : testing::Test {
    detail::BulletPoint point(btScalar x, btScalar z, btScalar depth = 0) const {
        detail::BulletPoint p;
        p.position = {x, 0, z};
        p.normal = {0, 1, 0};
        p.depth = depth;
        p.localA = p.position + p.normal * depth;
        p.localB = p.position;
        return p;
    }
    void set(const std::vector<detail::BulletPoint>& points, btScalar reach = 0.02_s) {
        detail::setPoints(manifold, points, reach, result);
    }
    std::map<btScalar, btScalar> impulsesByX() const {
        std::map<btScalar, btScalar> all;
        for (int i = 0; i < manifold.getNumContacts(); ++i) {
            all[manifold.getContactPoint(i).m_positionWorldOnB.x()] = manifold.getContactPoint(i).m_appliedImpulse;
        }
        return all;
    }
    btCollisionObject objects[2];
    btSphereShape shape{1};
    btCollisionObjectWrapper a{nullptr, &shape, &objects[0], objects[0].getWorldTransform(), -1, -1};
    btCollisionObjectWrapper b{nullptr, &shape, &objects[1], objects[1].getWorldTransform(), -1, -1};
    btPersistentManifold manifold{&objects[0], &objects[1], 0, 0.5_s, 1};  // a threshold that would merge them all
    btManifoldResult result{&a, &b};
};

TEST_F(Insertion, HoldsExactlyThePointsHoweverNear) {
    set({point(0, 0), point(0.1_s, 0), point(0, 0.1_s), point(0.1_s, 0.1_s)});
    EXPECT_EQ(manifold.getNumContacts(), 4);
    set({point(0, 0), point(0.1_s, 0)});
    EXPECT_EQ(manifold.getNumContacts(), 2);
    set({});
    EXPECT_EQ(manifold.getNumContacts(), 0);
    set({point(1, 0, 0.4_s)});
    ASSERT_EQ(manifold.getNumContacts(), 1);
    EXPECT_EQ(manifold.getContactPoint(0).getDistance(), 0.4_s);
}

TEST_F(Insertion, PointsThatMovedALittleKeepTheirImpulses) {
    set({point(0, 0), point(0.1_s, 0), point(0.2_s, 0)});
    for (int i = 0; i < 3; ++i) {
        manifold.getContactPoint(i).m_appliedImpulse = manifold.getContactPoint(i).m_positionWorldOnB.x() * 10 + 1;
    }
    // In another order, moved; one gone, one new.
    set({point(0.21_s, 0), point(0.9_s, 0), point(0.01_s, 0)});
    const std::map<btScalar, btScalar> found = impulsesByX();
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found.at(0.21_s), 0.2_s * 10 + 1);
    EXPECT_EQ(found.at(0.01_s), 1);
    EXPECT_EQ(found.at(0.9_s), 0);
}

TEST_F(Insertion, APointThatSlidOnOneBodyAloneIsTheSame) {
    set({point(0, 0)});
    manifold.getContactPoint(0).m_appliedImpulse = 7;
    detail::BulletPoint slid = point(0, 0);
    slid.localB = {0.3_s, 0, 0};
    slid.position = {0.3_s, 0, 0};
    slid.localA = {0, 0, 0};
    set({slid});
    ASSERT_EQ(manifold.getNumContacts(), 1);
    EXPECT_EQ(manifold.getContactPoint(0).m_appliedImpulse, 7);
    EXPECT_EQ(manifold.getContactPoint(0).m_positionWorldOnB.x(), 0.3_s);
}

TEST_F(Insertion, UserDataOfAPointThatEndsIsGivenBack) {
    static int destroyed = 0;
    destroyed = 0;
    gContactDestroyedCallback = [](void*) {
        ++destroyed;
        return true;
    };
    int tag = 0;
    set({point(0, 0), point(0.3_s, 0)});
    manifold.getContactPoint(0).m_userPersistentData = &tag;
    set({point(0.001_s, 0), point(0.3_s, 0)});
    EXPECT_EQ(destroyed, 0);
    EXPECT_EQ(manifold.getContactPoint(0).m_userPersistentData, &tag);
    set({point(5, 0), point(0.3_s, 0)});
    EXPECT_EQ(destroyed, 1);
    EXPECT_EQ(manifold.getNumContacts(), 2);
    gContactDestroyedCallback = nullptr;
}

}  // namespace
}  // namespace grapeshot::test
