#include <grapeshot/plugin/registration.hpp>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <gmock/gmock.h>

#include <limits>
#include <new>

#include <grapeshot/plugin/detail/dispatch_tables.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

using detail::creatorIn;
using detail::Table;

constexpr std::array ourTypes{TRIANGLE_MESH_SHAPE_PROXYTYPE, SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE,
                              GIMPACT_SHAPE_PROXYTYPE};

using Tables = std::vector<btCollisionAlgorithmCreateFunc*>;
Tables tablesOf(const btCollisionDispatcher& dispatcher) {
    Tables all;
    for (const Table table : {Table::contacts, Table::closest}) {
        for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
            for (int j = 0; j < MAX_BROADPHASE_COLLISION_TYPES; ++j) {
                all.push_back(creatorIn(dispatcher, table, i, j));
            }
        }
    }
    return all;
}

bool isOurs(const btCollisionDispatcher& dispatcher, Table table, int i, int j) {
    return dynamic_cast<AdbCollisionAlgorithm::CreateFunc*>(creatorIn(dispatcher, table, i, j)) != nullptr;
}

struct Dispatching : testing::Test {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
};

TEST_F(Dispatching, TakesBothTablesAndBothOrders) {
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    EXPECT_TRUE(isRegistered(&dispatcher));
    for (const Table table : {Table::contacts, Table::closest}) {
        for (const int i : ourTypes) {
            for (const int j : ourTypes) {
                EXPECT_TRUE(isOurs(dispatcher, table, i, j)) << i << ' ' << j;
            }
        }
        for (int i = 0; i < CONCAVE_SHAPES_START_HERE; ++i) {
            EXPECT_TRUE(isOurs(dispatcher, table, GIMPACT_SHAPE_PROXYTYPE, i)) << i;
            EXPECT_TRUE(isOurs(dispatcher, table, i, GIMPACT_SHAPE_PROXYTYPE)) << i;
            EXPECT_FALSE(isOurs(dispatcher, table, TRIANGLE_MESH_SHAPE_PROXYTYPE, i)) << i;
            EXPECT_FALSE(isOurs(dispatcher, table, i, TRIANGLE_MESH_SHAPE_PROXYTYPE)) << i;
        }
        EXPECT_TRUE(isOurs(dispatcher, table, GIMPACT_SHAPE_PROXYTYPE, STATIC_PLANE_PROXYTYPE));
        EXPECT_TRUE(isOurs(dispatcher, table, STATIC_PLANE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE));
    }
}

TEST_F(Dispatching, LeavesCompoundsSoftBodiesAndConvexPairsAlone) {
    const Tables before = tablesOf(dispatcher);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    for (const Table table : {Table::contacts, Table::closest}) {
        for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
            EXPECT_FALSE(isOurs(dispatcher, table, i, COMPOUND_SHAPE_PROXYTYPE)) << i;
            EXPECT_FALSE(isOurs(dispatcher, table, COMPOUND_SHAPE_PROXYTYPE, i)) << i;
            EXPECT_FALSE(isOurs(dispatcher, table, SOFTBODY_SHAPE_PROXYTYPE, i)) << i;
            for (int j = 0; i < CONCAVE_SHAPES_START_HERE && j < CONCAVE_SHAPES_START_HERE; ++j) {
                EXPECT_FALSE(isOurs(dispatcher, table, i, j)) << i << ' ' << j;
            }
        }
    }
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    EXPECT_EQ(tablesOf(dispatcher), before);
}

TEST_F(Dispatching, UnregisterRestoresGImpactToo) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    const Tables before = tablesOf(dispatcher);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    EXPECT_NE(tablesOf(dispatcher), before);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);  // twice changes nothing
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    EXPECT_EQ(tablesOf(dispatcher), before);
    EXPECT_FALSE(isRegistered(&dispatcher));
    EXPECT_EQ(unregisterAlgorithms(&dispatcher), Status::notRegistered);
}

TEST_F(Dispatching, NoticesThatItWasOvertaken) {
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    EXPECT_FALSE(isRegistered(&dispatcher));
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    EXPECT_TRUE(isRegistered(&dispatcher));
}

TEST_F(Dispatching, WhatOthersTookStaysTheirs) {
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    btCollisionAlgorithmCreateFunc other;
    dispatcher.registerCollisionCreateFunc(GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE, &other);
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    EXPECT_EQ(creatorIn(dispatcher, Table::contacts, GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE), &other);
}

TEST_F(Dispatching, ConvexPairsCanBeLeftOut) {
    Settings settings;
    settings.convexPairs = false;
    const Tables before = tablesOf(dispatcher);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    ASSERT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
    EXPECT_FALSE(isOurs(dispatcher, Table::contacts, GIMPACT_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE));
    EXPECT_TRUE(isOurs(dispatcher, Table::contacts, GIMPACT_SHAPE_PROXYTYPE, TRIANGLE_MESH_SHAPE_PROXYTYPE));
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    EXPECT_EQ(tablesOf(dispatcher), before);
}

TEST_F(Dispatching, RefusesBadSettingsAndNull) {
    EXPECT_EQ(registerAlgorithms(nullptr), Status::nullPointer);
    EXPECT_EQ(unregisterAlgorithms(nullptr), Status::nullPointer);
    EXPECT_FALSE(isRegistered(nullptr));
    EXPECT_EQ(statistics(nullptr).step, 0U);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refuses = [&](auto change) {
        Settings settings;
        change(settings);
        EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::badSettings);
        EXPECT_FALSE(isRegistered(&dispatcher));
    };
    refuses([](Settings& s) { s.maxManifolds = 0; });
    refuses([](Settings& s) { s.maxManifolds = 17; });
    refuses([&](Settings& s) { s.contactSpacing = nan; });
    refuses([](Settings& s) { s.contactSpacing = 0; });
    refuses([](Settings& s) { s.mergeDistance = 2; });
    refuses([](Settings& s) { s.slack = -1; });
    refuses([&](Settings& s) { s.lean = nan; });
    refuses([](Settings& s) { s.speculativeLimit = -1; });
    refuses([](Settings& s) { s.method = static_cast<Method>(77); });
    EXPECT_EQ(registerAlgorithms(&dispatcher, Settings::exact()), Status::ok);
}

TEST(Registration, AlgorithmFitsThePool) {
    // Bullet's pool has slots of 192 bytes and does not look.
    EXPECT_LE(sizeof(AdbCollisionAlgorithm), 64U);
}

TEST(Registration, SurvivesADispatcherAtTheAddressOfADeadOne) {
    btDefaultCollisionConfiguration configuration;
    alignas(btCollisionDispatcher) unsigned char place[sizeof(btCollisionDispatcher)];
    for (int round = 0; round < 3; ++round) {
        auto* dispatcher = new (place) btCollisionDispatcher(&configuration);
        EXPECT_FALSE(isRegistered(dispatcher));
        EXPECT_EQ(statistics(dispatcher).algorithms, 0U);
        EXPECT_EQ(registerAlgorithms(dispatcher), Status::ok);
        EXPECT_TRUE(isRegistered(dispatcher));
        MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
        btCollisionObject object;
        object.setCollisionShape(box.get());
        btCollisionObjectWrapper wrap(nullptr, box.get(), &object, object.getWorldTransform(), -1, -1);
        btCollisionAlgorithm* made = dispatcher->findAlgorithm(&wrap, &wrap, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        EXPECT_NE(dynamic_cast<AdbCollisionAlgorithm*>(made), nullptr);
        EXPECT_EQ(statistics(dispatcher).algorithms, 1U);
        made->~btCollisionAlgorithm();
        dispatcher->freeCollisionAlgorithm(made);
        dispatcher->~btCollisionDispatcher();  // without unregistering
    }
}

TEST(Registration, AlgorithmsOutliveTheirRegistration) {
    MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
    TestWorld world;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.01_s, 0}), 1);
    world.step(5);
    ASSERT_GT(world.dispatcher.getNumManifolds(), 0);
    ASSERT_EQ(unregisterAlgorithms(&world.dispatcher), Status::ok);
    world.step(60);
    EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 1.02, 0.01);
}

TEST(Registration, OwnCreateFuncWorksWithoutRegistration) {
    MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
    AdbCollisionAlgorithm::CreateFunc creator;
    TestWorld world({}, false);
    world.dispatcher.registerCollisionCreateFunc(GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE, &creator);
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.02_s, 0}), 1);
    world.step(60);
    EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 1.02, 0.01);
}

btCollisionAlgorithm* make(TestWorld& world, btCollisionShape& first, btCollisionShape& second) {
    btCollisionObject objects[2];
    objects[0].setCollisionShape(&first);
    objects[1].setCollisionShape(&second);
    btCollisionObjectWrapper a(nullptr, &first, &objects[0], objects[0].getWorldTransform(), -1, -1);
    btCollisionObjectWrapper b(nullptr, &second, &objects[1], objects[1].getWorldTransform(), -1, -1);
    return world.dispatcher.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
}

void destroy(TestWorld& world, btCollisionAlgorithm* algorithm) {
    algorithm->~btCollisionAlgorithm();
    world.dispatcher.freeCollisionAlgorithm(algorithm);
}

TEST(Fallback, GImpactCompoundAndHeightfieldGetBulletsAlgorithmAndAreCounted) {
    MeshShape mesh(scenes::box({0.5F, 0.5F, 0.5F}));
    btGImpactCompoundShape compound;
    btBoxShape child({0.5_s, 0.5_s, 0.5_s});
    compound.addChildShape(btTransform::getIdentity(), &child);
    compound.updateBound();
    const std::vector<float> heights(9, 0.0F);
    btHeightfieldTerrainShape terrain(3, 3, heights.data(), 1, -1, 1, 1, PHY_FLOAT, false);
    TestWorld world;
    std::uint64_t expected = 0;
    for (btCollisionShape* other :
         {static_cast<btCollisionShape*>(&compound), static_cast<btCollisionShape*>(&terrain)}) {
        for (const bool swapped : {false, true}) {
            btCollisionAlgorithm* made = swapped ? make(world, *other, *mesh) : make(world, *mesh, *other);
            EXPECT_NE(dynamic_cast<btGImpactCollisionAlgorithm*>(made), nullptr);
            EXPECT_EQ(world.stats().fallbacks, ++expected);
            destroy(world, made);
        }
    }
    EXPECT_EQ(world.stats().algorithms, 0U);
}

TEST(Fallback, WhoWasThereBeforeServesGImpactCompounds) {
    MeshShape mesh(scenes::box({0.5F, 0.5F, 0.5F}));
    btGImpactCompoundShape compound;
    TestWorld world({}, false);
    btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    btCollisionAlgorithm* made = make(world, *mesh, compound);
    EXPECT_NE(dynamic_cast<btGImpactCollisionAlgorithm*>(made), nullptr);
    EXPECT_EQ(world.stats().fallbacks, 0U);
    destroy(world, made);
}

}  // namespace
}  // namespace grapeshot::test
