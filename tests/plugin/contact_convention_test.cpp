// Normal, point, distance and margins of what Bullet is given, against formulas, in both orders.
#include <gmock/gmock.h>

#include <cmath>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

/// Two bodies in a world that is stepped once without motion; their contacts.
struct TwoBodies {
    TwoBodies(btCollisionShape& first, const btTransform& firstPose, btCollisionShape& second,
              const btTransform& secondPose) {
        world.world.setGravity({0, 0, 0});
        // Static bodies do not collide with each other; one may move but has no reason to.
        bodies[0] = &world.add(first, firstPose, 1, {1, 1, 1});
        bodies[1] = &world.add(second, secondPose, 0);
        world.world.performDiscreteCollisionDetection();
    }
    TestWorld world;
    btRigidBody* bodies[2];
};

/// The law of a contact point in Bullet, whatever the order of the bodies: points and distance fit, the normal points
/// from the manifold's body 1 to its body 0, local points are where the world points are.
void expectConsistent(TestWorld& world) {
    for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
        const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
        for (int i = 0; i < manifold.getNumContacts(); ++i) {
            const btManifoldPoint& p = manifold.getContactPoint(i);
            EXPECT_NEAR(p.m_normalWorldOnB.length(), 1, 1e-5);
            const btVector3 expected = p.m_positionWorldOnB + p.m_normalWorldOnB * p.getDistance();
            EXPECT_LT(expected.distance(p.m_positionWorldOnA), 1e-5);
            const btVector3 a = manifold.getBody0()->getWorldTransform() * p.m_localPointA;
            const btVector3 b = manifold.getBody1()->getWorldTransform() * p.m_localPointB;
            EXPECT_LT(a.distance(p.m_positionWorldOnA), 1e-5);
            EXPECT_LT(b.distance(p.m_positionWorldOnB), 1e-5);
        }
    }
}

class MeshPairs : public testing::TestWithParam<std::tuple<Kind, Kind, bool, btScalar>> {};

TEST_P(MeshPairs, SphereOnSphere) {
    const auto [upperKind, lowerKind, upperFirst, gap] = GetParam();
    const btScalar margin = 0.02_s;
    const MeshShape upper(scenes::sphere(0.5F, 20), upperKind, margin);
    const MeshShape lower(scenes::sphere(1.0F, 30), lowerKind, margin);
    const btTransform upperPose = at({0, 1.5_s + 2 * margin + gap, 0});
    const TwoBodies scene = upperFirst ? TwoBodies(*upper, upperPose, *lower, at({0, 0, 0}))
                                       : TwoBodies(*lower, at({0, 0, 0}), *upper, upperPose);
    TestWorld& world = const_cast<TestWorld&>(scene.world);
    expectConsistent(world);
    ASSERT_EQ(world.stats().refused, 0) << world.stats().lastRefusal;
    ASSERT_EQ(world.stats().pairs.size(), 1U);
    btScalar deepest = BT_LARGE_FLOAT;
    const btPersistentManifold* manifold = nullptr;
    btManifoldPoint point;
    for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
        manifold = world.dispatcher.getManifoldByIndexInternal(m);
        for (int i = 0; i < manifold->getNumContacts(); ++i) {
            if (manifold->getContactPoint(i).getDistance() < deepest) {
                point = manifold->getContactPoint(i);
                deepest = point.getDistance();
            }
        }
    }
    ASSERT_NE(manifold, nullptr);
    // A tessellated sphere is inside the true one by up to its sagitta, 2.5e-3 m here.
    EXPECT_NEAR(deepest, gap, 6e-3);
    const bool upperIsBody0 = manifold->getBody0()->getWorldTransform().getOrigin().y() > 1;
    EXPECT_NEAR(point.m_normalWorldOnB.y(), upperIsBody0 ? 1 : -1, 0.01);
    const btVector3& onUpper = upperIsBody0 ? point.m_positionWorldOnA : point.m_positionWorldOnB;
    const btVector3& onLower = upperIsBody0 ? point.m_positionWorldOnB : point.m_positionWorldOnA;
    // On the surfaces that the margins make.
    EXPECT_NEAR(onLower.y(), 1 + margin, 5e-3);
    EXPECT_NEAR(onUpper.y(), 1 + margin + gap, 5e-3);
    EXPECT_LT(btVector3(onLower.x(), 0, onLower.z()).length(), 0.1);
    EXPECT_NEAR(world.stats().deepest, btMax(0.0_s, -deepest), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(All, MeshPairs,
                         testing::Combine(testing::ValuesIn(allKinds), testing::ValuesIn(allKinds), testing::Bool(),
                                          testing::Values(0.008_s, -0.01_s, -0.06_s)));

TEST(Convention, NothingBeyondTheBreakingThreshold) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh, 0.02_s);
    const btScalar threshold = box.get()->getContactBreakingThreshold(gContactBreakingThreshold);
    TwoBodies near(*box, at({0, 1.04_s + 0.9_s * threshold, 0}), *box, at({0, 0, 0}));
    EXPECT_EQ(near.world.points().size(), 4U);
    TwoBodies far(*box, at({0, 1.04_s + 1.1_s * threshold, 0}), *box, at({0, 0, 0}));
    EXPECT_TRUE(far.world.points().empty());
    EXPECT_EQ(far.world.dispatcher.getNumManifolds(), 0);
}

TEST(Convention, MeshBoxOnMeshBoxTouchesWithItsFourCorners) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 3), Kind::mesh, 0.01_s);
    const MeshShape plate(scenes::box({2, 0.5F, 2}, 5), Kind::bvh, 0.03_s);
    TwoBodies scene(*box, at({0.1_s, 1.035_s, 0.2_s}), *plate, at({0, 0, 0}));
    const std::vector<btManifoldPoint> points = scene.world.points();
    ASSERT_EQ(points.size(), 4U);
    for (const btManifoldPoint& point : points) {
        EXPECT_NEAR(point.getDistance(), -0.005, 1e-5);
        EXPECT_NEAR(point.m_normalWorldOnB.y(), 1, 1e-6);
        EXPECT_NEAR(std::abs(point.m_positionWorldOnB.x() - 0.1), 0.5, 1e-5);
        EXPECT_NEAR(std::abs(point.m_positionWorldOnB.z() - 0.2), 0.5, 1e-5);
        EXPECT_NEAR(point.m_positionWorldOnB.y(), 0.53, 1e-5);
    }
    expectConsistent(scene.world);
}

TEST(Convention, FarFromTheOriginThePairIsTheSame) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh, 0.01_s);
    // Representable in single precision: what is lost is lost in Bullet's own transforms.
    const btVector3 away(4096, -2048, 1024);
    TwoBodies here(*box, at({0, 1.0_s, 0}), *box, at({0, 0, 0}));
    TwoBodies there(*box, at(away + btVector3(0, 1.0_s, 0)), *box, at(away));
    ASSERT_EQ(here.world.points().size(), there.world.points().size());
    ASSERT_FALSE(here.world.points().empty());
    // Bullet takes the distance of two points in the world.
    const double rounding = 1e-5 + 4096.0 * static_cast<double>(std::numeric_limits<btScalar>::epsilon());
    for (std::size_t i = 0; i < here.world.points().size(); ++i) {
        EXPECT_NEAR(here.world.points()[i].getDistance(), there.world.points()[i].getDistance(), rounding);
    }
}

TEST(Convention, TriangleNamesFollowTheManifoldsOrder) {
    const std::vector<scenes::Mesh> parts{scenes::moved(scenes::box({0.2F, 0.2F, 0.2F}), {5, 0, 0}),
                                          scenes::box({0.5F, 0.5F, 0.5F})};
    const MeshShape lower(parts, Kind::bvh);
    const MeshShape upper(scenes::box({0.4F, 0.5F, 0.4F}), Kind::part);
    for (const bool upperFirst : {false, true}) {
        const btTransform top = at({0, 1.015_s, 0});
        TwoBodies scene =
            upperFirst ? TwoBodies(*upper, top, *lower, at({0, 0, 0})) : TwoBodies(*lower, at({0, 0, 0}), *upper, top);
        ASSERT_GT(scene.world.dispatcher.getNumManifolds(), 0);
        for (int m = 0; m < scene.world.dispatcher.getNumManifolds(); ++m) {
            const btPersistentManifold& manifold = *scene.world.dispatcher.getManifoldByIndexInternal(m);
            const bool upperIs0 = manifold.getBody0()->getCollisionShape() == upper.get();
            for (int i = 0; i < manifold.getNumContacts(); ++i) {
                const btManifoldPoint& p = manifold.getContactPoint(i);
                EXPECT_EQ(upperIs0 ? p.m_partId0 : p.m_partId1, 0);
                EXPECT_EQ(upperIs0 ? p.m_partId1 : p.m_partId0, 1);
                const int triangle = upperIs0 ? p.m_index1 : p.m_index0;
                ASSERT_GE(triangle, 0);
                ASSERT_LT(triangle, static_cast<int>(parts[1].triangles.size()));
                // It is one of the top face.
                for (const std::uint32_t corner : parts[1].triangles[static_cast<std::size_t>(triangle)]) {
                    EXPECT_NEAR(parts[1].vertices[corner].y(), 0.5, 1e-6);
                }
            }
        }
    }
}

int callbackCalls = 0;
bool onContactAdded(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*,
                    int, int) {
    ++callbackCalls;
    point.m_combinedFriction = 0.123_s;
    return true;
}

TEST(Convention, TheProgramsMaterialCallbackIsCalled) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
    TestWorld world;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.015_s, 0}), 1);
    upper.setCollisionFlags(upper.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    callbackCalls = 0;
    gContactAddedCallback = onContactAdded;
    world.step();
    gContactAddedCallback = nullptr;
    EXPECT_EQ(callbackCalls, 4);
    for (const btManifoldPoint& point : world.points()) {
        EXPECT_EQ(point.m_combinedFriction, 0.123_s);
    }
}

TEST(Convention, FrictionAndRestitutionAreBulletsCombination) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
    TestWorld world;
    btRigidBody& lower = world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.015_s, 0}), 1);
    lower.setFriction(0.5_s);
    upper.setFriction(0.6_s);
    lower.setRestitution(0.5_s);
    upper.setRestitution(0.4_s);
    world.step();
    ASSERT_EQ(world.points().size(), 4U);
    EXPECT_NEAR(world.points()[0].m_combinedFriction, 0.3, 1e-6);
    EXPECT_NEAR(world.points()[0].m_combinedRestitution, 0.2, 1e-6);
}

TEST(Convention, OneInsideTheOtherIsPushedOutOnlyIfSolid) {
    const MeshShape small(scenes::sphere(0.2F, 4), Kind::mesh);
    const MeshShape big(scenes::box({1, 1, 1}, 2), Kind::mesh);
    for (const Interior interior : {Interior::solid, Interior::surface}) {
        Settings settings;
        settings.interior = interior;
        TestWorld world(settings);
        world.add(*big, at({0, 0, 0}));
        world.add(*small, at({0.3_s, 0, 0}), 1);
        world.world.performDiscreteCollisionDetection();
        if (interior == Interior::surface) {
            EXPECT_TRUE(world.points().empty());
        } else {
            ASSERT_FALSE(world.points().empty());
            EXPECT_LT(world.points()[0].getDistance(), -0.3);
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
