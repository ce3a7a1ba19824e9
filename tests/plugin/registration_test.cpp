#include <grapeshot/plugin/registration.hpp>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <gmock/gmock.h>

#include <limits>
#include <new>

#include <grapeshot/plugin/detail/dispatch_tables.hpp>

#include "bullet_fixture.hpp"
#include "own_concave_shape.hpp"

namespace grapeshot::test {
namespace {

using detail::creatorIn;
using detail::Table;

constexpr std::array ourTypes{TRIANGLE_MESH_SHAPE_PROXYTYPE, SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE,
                              MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE, TERRAIN_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE};

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
    return dynamic_cast<MeshCollisionAlgorithm::CreateFunc*>(creatorIn(dispatcher, table, i, j)) != nullptr;
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
        for (const int mesh : ourTypes) {
            EXPECT_TRUE(isOurs(dispatcher, table, mesh, STATIC_PLANE_PROXYTYPE)) << mesh;
            EXPECT_TRUE(isOurs(dispatcher, table, STATIC_PLANE_PROXYTYPE, mesh)) << mesh;
        }
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

TEST(SoftDispatching, TakesSoftBodiesAgainstMeshesAndEachOtherWhereTheyAreKnown) {
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    const Tables before = tablesOf(dispatcher);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    EXPECT_TRUE(isRegistered(&dispatcher));
    constexpr int soft = SOFTBODY_SHAPE_PROXYTYPE;
    const auto changed = [&](Table table, int first, int second) {
        return detail::creatorIn(dispatcher, table, first, second) !=
               (table == Table::contacts ? configuration.getCollisionAlgorithmCreateFunc(first, second)
                                         : configuration.getClosestPointsAlgorithmCreateFunc(first, second));
    };
    EXPECT_TRUE(changed(Table::contacts, soft, soft));
    for (const int mesh : ourTypes) {
        EXPECT_TRUE(changed(Table::contacts, soft, mesh)) << mesh;
        EXPECT_TRUE(changed(Table::contacts, mesh, soft)) << mesh;
        EXPECT_FALSE(changed(Table::closest, soft, mesh)) << mesh;
    }
    for (int i = 0; i < CONCAVE_SHAPES_START_HERE; ++i) {
        EXPECT_FALSE(changed(Table::contacts, soft, i)) << i;
        EXPECT_FALSE(changed(Table::contacts, i, soft)) << i;
    }
    Settings without;
    without.softPairs = false;
    ASSERT_EQ(registerAlgorithms(&dispatcher, without), Status::ok);
    EXPECT_FALSE(changed(Table::contacts, soft, soft));
    EXPECT_FALSE(changed(Table::contacts, soft, TRIANGLE_MESH_SHAPE_PROXYTYPE));
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
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

TEST_F(Dispatching, UnregisterLeavesAGImpactThatCameLaterAndRestoresTheRest) {
    const Tables plain = tablesOf(dispatcher);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    const Tables overtaken = tablesOf(dispatcher);
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    for (const Table table : {Table::contacts, Table::closest}) {
        for (int i = 0; i < MAX_BROADPHASE_COLLISION_TYPES; ++i) {
            for (int j = 0; j < MAX_BROADPHASE_COLLISION_TYPES; ++j) {
                EXPECT_FALSE(isOurs(dispatcher, table, i, j)) << i << ' ' << j;
            }
        }
    }
    const Tables after = tablesOf(dispatcher);
    std::size_t gimpacts = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        EXPECT_TRUE(after[i] == plain[i] || after[i] == overtaken[i]);
        gimpacts += after[i] != plain[i] ? 1 : 0;
    }
    EXPECT_EQ(gimpacts, 2U * MAX_BROADPHASE_COLLISION_TYPES - 1);  // the contact table's row and column
}

TEST_F(Dispatching, UnregisterAfterBothOrdersOfGImpactGivesGImpactBack) {
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    const btCollisionAlgorithmCreateFunc* gimpact =
        creatorIn(dispatcher, Table::contacts, GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE);
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);  // over it again
    ASSERT_TRUE(isRegistered(&dispatcher));
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    for (const int other : ourTypes) {
        EXPECT_EQ(creatorIn(dispatcher, Table::contacts, GIMPACT_SHAPE_PROXYTYPE, other), gimpact);
        EXPECT_EQ(creatorIn(dispatcher, Table::contacts, other, GIMPACT_SHAPE_PROXYTYPE), gimpact);
        EXPECT_FALSE(isOurs(dispatcher, Table::closest, GIMPACT_SHAPE_PROXYTYPE, other));
        EXPECT_FALSE(isOurs(dispatcher, Table::closest, other, GIMPACT_SHAPE_PROXYTYPE));
    }
}

TEST_F(Dispatching, TwiceRegisteredIsOnceUnregistered) {
    const Tables before = tablesOf(dispatcher);
    Settings other;
    other.maxManifolds = 3;
    for (int round = 0; round < 3; ++round) {
        ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
        ASSERT_EQ(registerAlgorithms(&dispatcher, other), Status::ok);
        ASSERT_EQ(registerAlgorithms(&dispatcher, other), Status::ok);
        ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
        EXPECT_EQ(tablesOf(dispatcher), before);
        EXPECT_EQ(unregisterAlgorithms(&dispatcher), Status::notRegistered);
        EXPECT_EQ(tablesOf(dispatcher), before);
    }
}

TEST_F(Dispatching, TheDispatcherWithABudgetCanBeUnregisteredToo) {
    const Tables plain = tablesOf(dispatcher);
    Dispatcher budgeted(&configuration);
    ASSERT_TRUE(isRegistered(&budgeted));
    ASSERT_EQ(unregisterAlgorithms(&budgeted), Status::ok);
    EXPECT_EQ(tablesOf(budgeted), plain);
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

/// After unregistering live pairs go on, and pairs that are made anew are Bullet's again.
template <class World>
void expectPartedPairsAreBulletsAgain() {
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}), Kind::bvh, 0.01_s);
    World world({}, false);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    world.add(*block, at({0, 0, 0}));
    btRigidBody& upper = world.add(*block, at({0, 1.01_s, 0}), 1);
    world.step(5);
    Collector found;
    world.world.contactTest(&upper, found);
    ASSERT_GT(found.points.size(), 0U);
    ASSERT_EQ(unregisterAlgorithms(&world.dispatcher), Status::ok);
    world.step(30);
    EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 1.02, 0.02);
    Collector none;
    world.world.contactTest(&upper, none);
    EXPECT_EQ(none.points.size(), 0U);
    world.world.getPairCache()->cleanProxyFromPairs(upper.getBroadphaseHandle(), &world.dispatcher);
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
    upper.activate();
    world.step(60);
    EXPECT_LT(upper.getWorldTransform().getOrigin().y(), 0);  // through the floor, as ever
}

TEST(Registration, PairsMadeAfterUnregisteringAreBulletsAgain) {
    expectPartedPairsAreBulletsAgain<TestWorld>();
    expectPartedPairsAreBulletsAgain<BudgetWorld>();
}

TEST(Registration, RegisteringAgainTakesNewPairsAndLeavesOldOnesTheirs) {
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}), Kind::bvh, 0.01_s);
    TestWorld world;
    world.add(*block, at({0, 0, 0}));
    btRigidBody& upper = world.add(*block, at({0, 1.01_s, 0}), 1);
    world.step(5);
    ASSERT_EQ(unregisterAlgorithms(&world.dispatcher), Status::ok);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    world.step(5);
    EXPECT_EQ(world.stats().pairs.size(), 0U);  // the old pair reports to the old registration
    EXPECT_GT(world.dispatcher.getNumManifolds(), 0);
    world.world.getPairCache()->cleanProxyFromPairs(upper.getBroadphaseHandle(), &world.dispatcher);
    world.step(5);
    EXPECT_EQ(world.stats().pairs.size(), 1U);
    EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 1.02, 0.02);
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

TEST(Registration, ScfHasItsOwnAlgorithmWhichServesThePair) {
    MeshShape ball(scenes::bumpySphere(0.5F, 0.1F, 5, 8));
    TestWorld world({}, false);
    ASSERT_EQ(ScfCollisionAlgorithm::registerAlgorithm(&world.dispatcher), Status::ok);
    world.add(*ball, at({0, 0, 0}));
    world.add(*ball, at({0, 1.05_s, 0}), 1);  // of the same shape, and so of the same ball tree
    world.step(30);
    ASSERT_EQ(world.stats().pairs.size(), 1U);
    EXPECT_EQ(world.stats().pairs[0].method, Method::scf);
    EXPECT_GT(world.stats().contacts, 0);
    EXPECT_EQ(world.stats().tracked, 1);
    EXPECT_EQ(world.stats().leftToAdb, 0);
    const btBroadphasePairArray& pairs = world.world.getPairCache()->getOverlappingPairArray();
    ASSERT_EQ(pairs.size(), 1);
    EXPECT_NE(dynamic_cast<ScfCollisionAlgorithm*>(pairs[0].m_algorithm), nullptr);
    ASSERT_EQ(AdbCollisionAlgorithm::registerAlgorithm(&world.dispatcher), Status::ok);
    world.step(5);
    EXPECT_EQ(world.stats().pairs[0].method, Method::adb) << "pairs that exist change their method";
}

TEST(Registration, ScfsOwnCreateFuncWorksWithoutRegistration) {
    MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}));
    ScfCollisionAlgorithm::CreateFunc creator;
    TestWorld world({}, false);
    world.dispatcher.registerCollisionCreateFunc(GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE, &creator);
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.02_s, 0}), 1);
    world.step(60);
    EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 1.02, 0.01);
    const btBroadphasePairArray& pairs = world.world.getPairCache()->getOverlappingPairArray();
    ASSERT_EQ(pairs.size(), 1);
    EXPECT_NE(dynamic_cast<ScfCollisionAlgorithm*>(pairs[0].m_algorithm), nullptr);
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

TEST(Fallback, AConcaveShapeOfTheProgramsGetsBulletsAlgorithmAndIsCounted) {
    MeshShape mesh(scenes::box({0.5F, 0.5F, 0.5F}));
    OwnConcaveShape own;
    TestWorld world;
    std::uint64_t expected = 0;
    for (const bool swapped : {false, true}) {
        btCollisionAlgorithm* made = swapped ? make(world, own, *mesh) : make(world, *mesh, own);
        EXPECT_NE(dynamic_cast<btGImpactCollisionAlgorithm*>(made), nullptr);
        EXPECT_EQ(world.stats().fallbacks, ++expected);
        destroy(world, made);
    }
    EXPECT_EQ(world.stats().algorithms, 0U);
}

TEST(Fallback, WhoWasThereBeforeServesWhatIsNotOurs) {
    MeshShape mesh(scenes::box({0.5F, 0.5F, 0.5F}));
    OwnConcaveShape own;
    btGImpactCompoundShape compound;
    Settings settings;
    settings.convexPairs = false;
    TestWorld world({}, false);
    btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
    ASSERT_EQ(registerAlgorithms(&world.dispatcher, settings), Status::ok);
    for (btCollisionShape* other : {static_cast<btCollisionShape*>(&own), static_cast<btCollisionShape*>(&compound)}) {
        btCollisionAlgorithm* made = make(world, *mesh, *other);
        EXPECT_NE(dynamic_cast<btGImpactCollisionAlgorithm*>(made), nullptr) << other->getName();
        destroy(world, made);
    }
    EXPECT_EQ(world.stats().fallbacks, 0U);
}

TEST_F(Dispatching, CompoundsComeBackToBulletsRecursionAfterGImpact) {
    const auto compoundsOf = [&](Table table) {
        return std::array{creatorIn(dispatcher, table, COMPOUND_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE),
                          creatorIn(dispatcher, table, GIMPACT_SHAPE_PROXYTYPE, COMPOUND_SHAPE_PROXYTYPE)};
    };
    const auto plain = compoundsOf(Table::contacts);
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    const auto taken = compoundsOf(Table::contacts);
    ASSERT_NE(taken, plain);
    Settings settings;
    settings.speculative = false;
    const auto expectRecursion = [&] {
        // Contacts ahead of children come from an algorithm of ours, which asks the recursion first.
        const auto there = compoundsOf(Table::contacts);
        if (settings.speculative) {
            EXPECT_NE(there, taken);
        } else {
            EXPECT_EQ(there, plain);
        }
    };
    for (const bool speculative : {false, true}) {
        settings.speculative = speculative;
        settings.convexPairs = true;
        ASSERT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        expectRecursion();
        settings.convexPairs = false;
        ASSERT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        EXPECT_EQ(compoundsOf(Table::contacts), taken);
        settings.convexPairs = true;
        ASSERT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        expectRecursion();
        ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
        EXPECT_EQ(compoundsOf(Table::contacts), taken);
    }
}

TEST_F(Dispatching, ConvexAgainstBvhIsTakenOnlyWhenAsked) {
    const Tables before = tablesOf(dispatcher);
    Settings settings;
    settings.bvhConvexPairs = true;
    ASSERT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
    for (const Table table : {Table::contacts, Table::closest}) {
        for (const int mesh : ourTypes) {
            for (int i = 0; i < CONCAVE_SHAPES_START_HERE; ++i) {
                EXPECT_TRUE(isOurs(dispatcher, table, mesh, i)) << mesh << ' ' << i;
                EXPECT_TRUE(isOurs(dispatcher, table, i, mesh)) << mesh << ' ' << i;
            }
        }
    }
    ASSERT_EQ(registerAlgorithms(&dispatcher), Status::ok);
    EXPECT_FALSE(isOurs(dispatcher, Table::contacts, TRIANGLE_MESH_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE));
    ASSERT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    EXPECT_EQ(tablesOf(dispatcher), before);
}

}  // namespace
}  // namespace grapeshot::test
