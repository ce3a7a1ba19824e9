// contactTest and contactPairTest, where GImpact returns nothing.
#include <gmock/gmock.h>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

TEST(Queries, AnswerForEveryPairOfKindsInBothOrders) {
    for (const Kind first : allKinds) {
        for (const Kind second : allKinds) {
            const MeshShape upper(scenes::box({0.5F, 0.5F, 0.5F}, 2), first);
            const MeshShape lower(scenes::torus(1, 0.4F, 24, 12), second);
            TestWorld world;
            btRigidBody& a = world.add(*upper, at({1.0_s, 0.89_s, 0}));
            btRigidBody& b = world.add(*lower, at({0, 0, 0}));
            Collector forwards;
            world.world.contactPairTest(&a, &b, forwards);
            Collector backwards;
            world.world.contactPairTest(&b, &a, backwards);
            Collector all;
            world.world.contactTest(&a, all);
            ASSERT_FALSE(forwards.points.empty());
            ASSERT_FALSE(backwards.points.empty());
            ASSERT_FALSE(all.points.empty());
            EXPECT_NEAR(forwards.deepest(), -0.03, 5e-3);
            EXPECT_NEAR(forwards.deepest(), backwards.deepest(), 1e-4);
            EXPECT_NEAR(forwards.deepest(), all.deepest(), 1e-4);
            // The normal points to the first body of the query.
            EXPECT_GT(forwards.points[0].m_normalWorldOnB.y(), 0.5);
            EXPECT_LT(backwards.points[0].m_normalWorldOnB.y(), -0.5);
            EXPECT_EQ(forwards.firsts[0], &a);
            EXPECT_EQ(backwards.firsts[0], &b);
            EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
            EXPECT_EQ(world.stats().queries, 3U);
            EXPECT_GT(world.stats().queryWork, 0U);
            EXPECT_EQ(world.stats().step, 0U);
        }
    }
}

TEST(Queries, AreTheSameEachTime) {
    const MeshShape a(scenes::bumpySphere(0.5F, 0.1F, 5, 6), Kind::mesh);
    TestWorld world;
    btRigidBody& first = world.add(*a, at({0, 0.9_s, 0}));
    btRigidBody& second = world.add(*a, at({0, 0, 0}, btQuaternion({0, 0, 1}, 0.5_s)));
    Collector before;
    world.world.contactPairTest(&first, &second, before);
    for (int i = 0; i < 3; ++i) {
        Collector again;
        world.world.contactPairTest(&first, &second, again);
        ASSERT_EQ(again.points.size(), before.points.size());
        for (std::size_t p = 0; p < again.points.size(); ++p) {
            EXPECT_EQ(again.points[p].getDistance(), before.points[p].getDistance());
        }
    }
}

TEST(Queries, SeparatedPairsGiveTheClosestPointsUpToTheThreshold) {
    const btScalar margin = 0.02_s;
    const MeshShape a(scenes::sphere(0.5F, 10), Kind::mesh, margin);
    const MeshShape b(scenes::torus(1, 0.4F, 48, 24), Kind::bvh, margin);
    const btBoxShape box({0.5_s, 0.5_s, 0.5_s});
    TestWorld world;
    btRigidBody& meshBody = world.add(*a, at({1.0_s, 3.4_s, 0}));
    btRigidBody& torus = world.add(*b, at({0, 0, 0}));
    const btScalar expected = 3.4_s - 0.5_s - 0.4_s - 2 * margin;
    for (const bool swapped : {false, true}) {
        Collector near;
        near.m_closestDistanceThreshold = 2;
        world.world.contactPairTest(swapped ? &torus : &meshBody, swapped ? &meshBody : &torus, near);
        EXPECT_TRUE(near.points.empty());
        Collector far;
        far.m_closestDistanceThreshold = 3;
        world.world.contactPairTest(swapped ? &torus : &meshBody, swapped ? &meshBody : &torus, far);
        ASSERT_EQ(far.points.size(), 1U);
        EXPECT_NEAR(far.points[0].getDistance(), expected, 0.01);
        EXPECT_NEAR(far.points[0].m_normalWorldOnB.y(), swapped ? -1 : 1, 0.02);
    }
    Collector none;
    world.world.contactPairTest(&meshBody, &torus, none);
    EXPECT_TRUE(none.points.empty());
}

TEST(Queries, ClosestPointsToAConvexShape) {
    const MeshShape mesh(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh, 0.01_s);
    btBoxShape box({0.5_s, 0.5_s, 0.5_s});
    btSphereShape sphere(0.5_s);
    for (btCollisionShape* other : {static_cast<btCollisionShape*>(&box), static_cast<btCollisionShape*>(&sphere)}) {
        TestWorld world;
        btRigidBody& a = world.add(*mesh, at({0, 0, 0}));
        btRigidBody& b = world.add(*other, at({0.05_s, 2, 0.1_s}));
        Collector found;
        found.m_closestDistanceThreshold = 5;
        world.world.contactPairTest(&a, &b, found);
        ASSERT_EQ(found.points.size(), 1U);
        EXPECT_NEAR(found.points[0].getDistance(), 0.99, 1e-4);
        EXPECT_NEAR(found.points[0].m_normalWorldOnB.y(), -1, 1e-4);
    }
}

TEST(Queries, BudgetLimitsTheWork) {
    const MeshShape mesh(scenes::bumpySphere(0.5F, 0.1F, 7, 24), Kind::mesh);
    Settings settings;
    settings.queryBudget.work = 10;
    std::uint64_t limited = 0;
    std::uint64_t full = 0;
    for (const bool isLimited : {true, false}) {
        TestWorld world(isLimited ? settings : Settings{});
        btRigidBody& a = world.add(*mesh, at({0.02_s, 0.8_s, 0.01_s}));
        btRigidBody& b = world.add(*mesh, at({0, 0, 0}));
        Collector found;
        world.world.contactPairTest(&a, &b, found);
        (isLimited ? limited : full) = world.stats().queryWork;
    }
    EXPECT_LE(limited, 10U);
    EXPECT_GT(full, 30U);
}

TEST(Queries, DoNotDisturbTheSimulation) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    std::vector<btVector3> ends;
    for (const bool asking : {false, true}) {
        TestWorld world;
        btRigidBody& lower = world.add(*box, at({0, 0, 0}));
        btRigidBody& upper = world.add(*box, at({0.2_s, 1.1_s, 0}, btQuaternion({0, 0, 1}, 0.2_s)), 1);
        for (int i = 0; i < 60; ++i) {
            world.step();
            if (asking) {
                Collector found;
                world.world.contactPairTest(&upper, &lower, found);
                world.world.contactTest(&lower, found);
            }
        }
        ends.push_back(upper.getWorldTransform().getOrigin());
    }
    EXPECT_TRUE(ends[0] == ends[1]);
}

}  // namespace
}  // namespace grapeshot::test
