// Dispatcher in place of btCollisionDispatcher: what stays the same, and what a program may do to it.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Character/btKinematicCharacterController.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <optional>
#include <type_traits>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

static_assert(!std::is_constructible_v<Dispatcher, Dispatcher&>, "Bullet's pools would be freed twice");

/// Meshes, convex bodies, a compound of meshes and a plane, all on one heap.
struct Mixture {
    MeshShape ball{scenes::bumpySphere(0.4F, 0.08F, 5, 6), Kind::mesh};
    MeshShape torus{scenes::torus(0.4F, 0.15F, 20, 10), Kind::bvh};
    MeshShape floor{scenes::grid(6, 6, 10, 10), Kind::bvh};
    btBoxShape box{{0.3_s, 0.2_s, 0.3_s}};
    btCylinderShape cylinder{{0.2_s, 0.3_s, 0.2_s}};
    btCompoundShape compound;

    Mixture() {
        compound.addChildShape(at({-0.5_s, 0, 0}), torus.get());
        compound.addChildShape(at({0.5_s, 0, 0}), ball.get());
        for (const MeshShape* shape : {&ball, &torus, &floor}) {  // or the first run under a budget waits for trees
            EXPECT_EQ(prebuild(shape->get()), Status::ok);
        }
    }
    template <class World>
    void fill(World& world) {
        world.add(*floor, at({0, 0, 0}));
        for (int i = 0; i < 15; ++i) {
            btCollisionShape* const shapes[] = {ball.get(), &box, torus.get(), &cylinder, &compound};
            const btVector3 place(0.15_s * btScalar(i % 3), 0.7_s + 0.5_s * btScalar(i), 0.1_s * btScalar(i % 4));
            world.add(*shapes[i % 5], at(place, btQuaternion({0.2_s, 1, 0.5_s}, btScalar(i))), 1,
                      i % 5 == 4 ? btVector3(0.3_s, 0.3_s, 0.3_s) : btVector3(0, 0, 0));
        }
    }
};

template <class World>
std::vector<std::uint64_t> run(const Settings& settings, int count = 150) {
    Mixture mixture;
    World world(settings);
    mixture.fill(world);
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < count; ++i) {
        world.step();
        hashes.push_back(hashOf(world));
    }
    EXPECT_GT(world.dispatcher.getNumManifolds(), 5);
    return hashes;
}

TEST(Dispatcher, WithoutABudgetItGivesTheBytesOfRegisterAlgorithms) {
    EXPECT_EQ(run<BudgetWorld>({}), run<TestWorld>({}));
    Settings pairwise;
    pairwise.pairBudget.work = 15;
    const auto cut = run<TestWorld>(pairwise, 100);
    EXPECT_EQ(run<BudgetWorld>(pairwise, 100), cut);
    EXPECT_NE(run<TestWorld>({}, 100), cut) << "the budget is never felt";
}

TEST(Dispatcher, TheSameBytesOnAnyNumberOfThreads) {
    for (const std::uint64_t work : {unlimited, std::uint64_t{600}, std::uint64_t{100}}) {
        Settings settings;
        settings.frameBudget.work = work;
        const auto one = run<BudgetWorld>(settings);
        for (const int threads : {2, 4}) {
            settings.threads = threads;
            EXPECT_EQ(run<BudgetWorld>(settings), one) << threads << " threads, " << work << " units";
        }
    }
    Settings settings;
    settings.threads = 0;
    TestWorld world;
    EXPECT_EQ(registerAlgorithms(&world.dispatcher, settings), Status::badSettings);
}

/// A dispatcher of the program's, with a constructor of its own.
class Counting : public btCollisionDispatcher {
  public:
    Counting(btCollisionConfiguration* configuration, int& dispatches)
        : btCollisionDispatcher(configuration), m_dispatches(dispatches) {}
    void dispatchAllCollisionPairs(btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                   btDispatcher* dispatcher) override {
        ++m_dispatches;
        btCollisionDispatcher::dispatchAllCollisionPairs(cache, info, dispatcher);
    }

  private:
    int& m_dispatches;
};

TEST(Dispatcher, StandsOverAnySubclass) {
    int dispatches = 0;
    btDefaultCollisionConfiguration configuration;
    BasicDispatcher<Counting> dispatcher(&configuration, dispatches);
    EXPECT_EQ(dispatcher.status(), Status::ok);
    EXPECT_TRUE(isRegistered(&dispatcher));
    btDbvtBroadphase broadphase;
    btCollisionWorld world(&dispatcher, &broadphase, &configuration);
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    btCollisionObject lower;
    btCollisionObject upper;
    lower.setCollisionShape(box.get());
    upper.setCollisionShape(box.get());
    upper.setWorldTransform(at({0, 0.99_s, 0}));
    world.addCollisionObject(&lower, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
    world.addCollisionObject(&upper, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
    world.performDiscreteCollisionDetection();
    EXPECT_EQ(dispatches, 1);
    EXPECT_EQ(dispatcher.getNumManifolds(), 1);
    EXPECT_EQ(statistics(&dispatcher).contacts, 4);
    EXPECT_EQ(statistics(&dispatcher).dispatches, 1);
}

TEST(Dispatcher, IsRegisteredFromTheStartAndGoneAtTheEnd) {
    btDefaultCollisionConfiguration configuration;
    std::optional<Dispatcher> dispatcher(std::in_place, &configuration);
    const btCollisionDispatcher* const address = &*dispatcher;
    EXPECT_TRUE(isRegistered(address));
    EXPECT_EQ(unregisterAlgorithms(&*dispatcher), Status::ok);
    EXPECT_FALSE(isRegistered(address));
    EXPECT_EQ(registerAlgorithms(&*dispatcher), Status::ok);
    dispatcher.reset();
    // Another one, at the same address.
    dispatcher.emplace(&configuration);
    EXPECT_EQ(statistics(address).step, 0U);
    EXPECT_TRUE(isRegistered(address));
}

/// Bullet wants the world to go first. A world whose bodies have left asks nothing of its dispatcher any more.
TEST(Dispatcher, MayGoBeforeOrAfterAnEmptyWorld) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    for (const bool dispatcherFirst : {true, false}) {
        btDefaultCollisionConfiguration configuration;
        auto dispatcher = std::make_unique<Dispatcher>(&configuration);
        btDbvtBroadphase broadphase;
        btSequentialImpulseConstraintSolver solver;
        auto world = std::make_unique<btDiscreteDynamicsWorld>(dispatcher.get(), &broadphase, &solver, &configuration);
        btRigidBody lower(0, nullptr, box.get());
        btRigidBody upper(1, nullptr, box.get(), {0.1_s, 0.1_s, 0.1_s});
        upper.setWorldTransform(at({0, 1.01_s, 0}));
        world->addRigidBody(&lower);
        world->addRigidBody(&upper);
        world->stepSimulation(1.0_s / 60, 0);
        EXPECT_EQ(dispatcher->getNumManifolds(), 1);
        world->removeRigidBody(&lower);
        world->removeRigidBody(&upper);
        EXPECT_EQ(dispatcher->getNumManifolds(), 0);
        if (dispatcherFirst) {
            dispatcher.reset();
        }
        world.reset();
    }
}

int seenPairs = 0;
const btCollisionObject* unwanted = nullptr;

void filteringCallback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
    ++seenPairs;
    if (pair.m_pProxy0->m_clientObject != unwanted && pair.m_pProxy1->m_clientObject != unwanted) {
        btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    }
}

template <class World>
std::vector<std::uint64_t> runFiltered(int from, int& seen) {
    Mixture mixture;
    World world;
    mixture.fill(world);
    world.dispatcher.setNearCallback(filteringCallback);
    std::vector<std::uint64_t> hashes;
    seen = 0;
    for (int i = 0; i < 120; ++i) {
        // Now and then a body is a ghost to all others.
        unwanted = i >= from && i < from + 20 ? world.bodies[3].get() : nullptr;
        seenPairs = 0;
        world.step();
        seen += seenPairs;
        hashes.push_back(hashOf(world));
    }
    unwanted = nullptr;
    return hashes;
}

TEST(Dispatcher, TheProgramsNearCallbackIsAskedAsEver) {
    for (const int from : {0, 40}) {
        int seen = 0;
        int plainSeen = 0;
        const auto plain = runFiltered<TestWorld>(from, plainSeen);
        EXPECT_EQ(runFiltered<BudgetWorld>(from, seen), plain);
        EXPECT_EQ(seen, plainSeen);
    }
}

/// A character and a sensor among rocks, each with a pair cache of its own.
template <class World, class Check>
std::vector<std::uint64_t> runGhosts(const Settings& settings, Check&& check) {
    const MeshShape floor(scenes::box({12, 0.5F, 12}, 40), Kind::bvh);
    const MeshShape rock(scenes::bumpySphere(0.5F, 0.1F, 5, 12), Kind::mesh);
    btCapsuleShape capsule(0.4_s, 1);
    btGhostPairCallback callback;  // the world's end still calls it
    World world(settings);
    world.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&callback);
    world.add(*floor, at({0, -0.5_s, 0}));
    world.add(*rock, at({1.1_s, 0.4_s, 0}));
    for (int i = 0; i < 4; ++i) {
        world.add(*rock, at({-1.5_s, 0.6_s + btScalar(i), 0.1_s * btScalar(i)}), 1);
    }
    btPairCachingGhostObject walker;
    walker.setCollisionShape(&capsule);
    walker.setCollisionFlags(btCollisionObject::CF_CHARACTER_OBJECT);
    walker.setWorldTransform(at({0, 1, 0}));
    btKinematicCharacterController controller(&walker, &capsule, 0.3_s, {0, 1, 0});
    world.world.addCollisionObject(&walker, btBroadphaseProxy::CharacterFilter,
                                   btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter);
    world.world.addAction(&controller);
    controller.setWalkDirection({0.02_s, 0, 0});
    btPairCachingGhostObject sensor;
    sensor.setCollisionShape(rock.get());
    sensor.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
    sensor.setWorldTransform(at({-1.5_s, 0.5_s, 0}));
    world.world.addCollisionObject(&sensor, btBroadphaseProxy::SensorTrigger,
                                   btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::SensorTrigger);
    std::vector<std::uint64_t> hashes;
    for (std::uint64_t i = 0; i < 150; ++i) {
        world.step();
        btHashedOverlappingPairCache& pairs = *sensor.getOverlappingPairCache();
        world.dispatcher.dispatchAllCollisionPairs(&pairs, world.world.getDispatchInfo(), &world.dispatcher);
        btManifoldArray sensed;
        for (int k = 0; k < pairs.getNumOverlappingPairs(); ++k) {
            btCollisionAlgorithm* algorithm = pairs.getOverlappingPairArray()[k].m_algorithm;
            if (algorithm != nullptr) {
                algorithm->getAllContactManifolds(sensed);
            }
        }
        check(i, world.stats(), sensed.size());
        hashes.push_back(hashOf(world) ^
                         std::bit_cast<std::uint64_t>(static_cast<double>(walker.getWorldTransform().getOrigin().x())));
    }
    for (const auto& body : world.bodies) {
        EXPECT_GT(body->getWorldTransform().getOrigin().y(), -0.6_s);
    }
    EXPECT_GT(walker.getWorldTransform().getOrigin().x(), 0.05_s);
    world.world.removeAction(&controller);
    world.world.removeCollisionObject(&walker);
    world.world.removeCollisionObject(&sensor);
    return hashes;
}

TEST(Dispatcher, GhostsAndControllersShareTheFrame) {
    const auto nothing = [](std::uint64_t, const StepStatistics&, int) {};
    EXPECT_EQ(runGhosts<BudgetWorld>({}, nothing), runGhosts<TestWorld>({}, nothing));
    for (const std::uint64_t work : {0U, 800U, 3000U}) {
        SCOPED_TRACE(work);
        Settings settings;
        settings.frameBudget.work = work;
        int several = 0;
        int sensed = 0;
        runGhosts<BudgetWorld>(settings, [&](std::uint64_t i, const StepStatistics& s, int manifolds) {
            EXPECT_EQ(s.step, i + 1);
            // How often the controller will call is not known when the step begins.
            EXPECT_LE(s.work, s.budget + s.mandatory) << "step " << i;
            several += s.dispatches > 2 ? 1 : 0;
            sensed += manifolds;
        });
        EXPECT_GT(several, 100);
        EXPECT_GT(sensed, 100);
    }
}

btDiscreteDynamicsWorld* callbackWorld = nullptr;
btRigidBody* victim = nullptr;
int removals = 0;

bool removingCallback(btManifoldPoint&, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int,
                      int) {
    if (victim != nullptr) {
        callbackWorld->removeRigidBody(victim);
        victim = nullptr;
        ++removals;
    }
    return false;
}

/// The body that the contact is of, and another one.
TEST(Dispatcher, ABodyMayBeRemovedInAContactCallback) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 3), Kind::mesh);
    gContactAddedCallback = removingCallback;
    for (const std::size_t which : {1U, 2U, 3U}) {
        for (const int before : {0, 1, 5}) {
            BudgetWorld world;
            world.world.getDispatchInfo().m_deterministicOverlappingPairs = false;
            callbackWorld = &world.world;
            world.add(*box, at({0, 0, 0}));
            for (int i = 1; i <= 3; ++i) {
                btRigidBody& body = world.add(*box, at({0, 1.01_s * btScalar(i), 0}), 1);
                body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
                body.setActivationState(DISABLE_DEACTIVATION);
            }
            world.step(before);
            const int had = removals;
            victim = world.bodies[which].get();
            world.step();
            EXPECT_EQ(removals, had + 1);
            const btRigidBody* const gone = world.bodies[which].get();
            for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
                const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
                EXPECT_NE(manifold.getBody0(), gone);
                EXPECT_NE(manifold.getBody1(), gone);
            }
            world.bodies.erase(world.bodies.begin() + static_cast<std::ptrdiff_t>(which));
            world.step(60);
            EXPECT_GT(world.bodies[1]->getWorldTransform().getOrigin().y(), 0.9_s);
            EXPECT_EQ(world.world.getNumCollisionObjects(), 3);
        }
    }
    gContactAddedCallback = nullptr;
}

/// Another shape ends the old contacts, and the program reacts to that: not before Bullet's pass is at the pair.
TEST(Dispatcher, ABodyMayBeRemovedWhenAnotherShapeEndsItsContact) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}, 3), Kind::mesh);
    const MeshShape other(scenes::box({0.4F, 0.5F, 0.4F}, 2), Kind::mesh);
    BudgetWorld world;
    world.world.getDispatchInfo().m_deterministicOverlappingPairs = false;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& gone = world.add(*box, at({0, 1.01_s, 0}), 1);
    btRigidBody& kept = world.add(*box, at({0, 2.02_s, 0}), 1);
    kept.setActivationState(DISABLE_DEACTIVATION);
    world.step(5);
    ASSERT_FALSE(world.points().empty());
    callbackWorld = &world.world;
    victim = &gone;
    const int had = removals;
    gContactEndedCallback = [](btPersistentManifold* const&) {
        if (victim != nullptr) {
            btRigidBody* const body = victim;
            victim = nullptr;
            ++removals;
            callbackWorld->removeRigidBody(body);
        }
    };
    gone.setCollisionShape(other.get());
    world.step();
    gContactEndedCallback = nullptr;
    EXPECT_EQ(removals, had + 1);
    EXPECT_EQ(world.world.getNumCollisionObjects(), 2);
    world.bodies.erase(world.bodies.begin() + 1);
    world.step(60);
    EXPECT_GT(kept.getWorldTransform().getOrigin().y(), 0.9_s);
}

TEST(Dispatcher, MayBeRegisteredAnewInMidRun) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    BudgetWorld world;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.02_s, 0}), 1);
    upper.setActivationState(DISABLE_DEACTIVATION);
    world.step(10);
    ASSERT_EQ(unregisterAlgorithms(&world.dispatcher), Status::ok);
    world.step(10);
    EXPECT_FALSE(world.points().empty()) << "the pair keeps its algorithm";
    ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
    for (std::uint64_t i = 1; i <= 10; ++i) {
        world.step();
        EXPECT_EQ(world.stats().step, i);
        EXPECT_LE(world.stats().pairs.size(), 1U);
    }
    EXPECT_FALSE(world.points().empty());
    EXPECT_GT(upper.getWorldTransform().getOrigin().y(), 0.9_s);
}

TEST(Dispatcher, ANaNPoseIsRefusedAndTheOthersGoOn) {
    const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    Settings settings;
    settings.frameBudget.work = 100;
    settings.threads = 2;
    BudgetWorld world(settings);
    world.add(*box, at({0, 0, 0}));
    btRigidBody& lost = world.add(*box, at({0, 1.02_s, 0}), 1);
    btRigidBody& kept = world.add(*box, at({0.2_s, 2.04_s, 0}), 1);
    kept.setActivationState(DISABLE_DEACTIVATION);
    lost.setActivationState(DISABLE_DEACTIVATION);
    world.step(10);
    ASSERT_FALSE(world.points().empty());
    btOverlappingPairCache& pairs = *world.broadphase.getOverlappingPairCache();
    lost.getWorldTransform().setOrigin({nan, nan, nan});
    world.dispatcher.dispatchAllCollisionPairs(&pairs, world.world.getDispatchInfo(), &world.dispatcher);
    EXPECT_EQ(world.stats().refused, 2);
    EXPECT_TRUE(world.points().empty());
    world.remove(lost);
    world.step(180);
    EXPECT_NEAR(kept.getWorldTransform().getOrigin().y(), 1.02, 0.02);
}

/// Each with all others: 10,011 pairs.
TEST(Dispatcher, TenThousandPairsAtOnePointDoNotExplode) {
    const MeshShape box(scenes::box({0.1F, 0.1F, 0.1F}), Kind::mesh);
    Settings settings;
    settings.frameBudget.work = 2000;
    settings.maxManifolds = 1;
    BudgetWorld world(settings);
    world.world.setGravity({0, 0, 0});
    for (int i = 0; i < 142; ++i) {
        world.add(*box, at({0, 0, 0}), 1);
    }
    for (int i = 0; i < 3; ++i) {
        world.step();
        const StepStatistics& s = world.stats();
        if (i == 0) {
            EXPECT_EQ(s.pairs.size(), 10011U);
        }
        EXPECT_LE(s.work, std::max(s.budget, s.mandatory));
        EXPECT_LE(s.mandatory, 88 * s.pairs.size());
        EXPECT_LE(s.manifolds, 2 * 10011);
    }
    for (const auto& body : world.bodies) {
        EXPECT_LT(body->getWorldTransform().getOrigin().length(), 50);
    }
}

/// Ten thousand bodies at one point that see the floor alone.
TEST(Dispatcher, TenThousandBodiesAtOnePointDoNotExplode) {
    const MeshShape box(scenes::box({0.1F, 0.1F, 0.1F}), Kind::mesh);
    const MeshShape floor(scenes::box({1, 0.1F, 1}, 4), Kind::bvh);
    Settings settings;
    settings.frameBudget.work = 2000;
    BudgetWorld world(settings);
    world.add(*floor, at({0, -0.1_s, 0}));
    for (int i = 0; i < 10000; ++i) {
        btRigidBody& body = world.add(*box, at({0, 0.11_s, 0}), 1);
        world.world.removeRigidBody(&body);
        world.world.addRigidBody(&body, btBroadphaseProxy::DebrisFilter, btBroadphaseProxy::StaticFilter);
    }
    for (int i = 0; i < 2; ++i) {
        world.step();
        const StepStatistics& s = world.stats();
        EXPECT_EQ(s.pairs.size(), 10000U);
        EXPECT_LE(s.work, std::max(s.budget, s.mandatory));
        EXPECT_LE(s.mandatory, 880000U);
    }
    for (const auto& body : world.bodies) {
        EXPECT_GT(body->getWorldTransform().getOrigin().y(), -0.2_s);
    }
}

TEST(Dispatcher, ACallbackMayMoveABodyBeforeItsPairsCome) {
    const MeshShape box(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    BudgetWorld world;
    world.add(*box, at({0, 0, 0}));
    btRigidBody& upper = world.add(*box, at({0, 1.0_s, 0}), 1);
    static btRigidBody* moved = nullptr;
    moved = &upper;
    world.step(2);
    world.dispatcher.setNearCallback(
        [](btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
            moved->getWorldTransform().getOrigin().setY(0.97_s);
            btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
        });
    world.dispatcher.dispatchAllCollisionPairs(world.broadphase.getOverlappingPairCache(),
                                               world.world.getDispatchInfo(), &world.dispatcher);
    ASSERT_FALSE(world.points().empty());
    for (const btManifoldPoint& point : world.points()) {
        EXPECT_NEAR(point.getDistance(), -0.05, 1e-4);
    }
}

}  // namespace
}  // namespace grapeshot::test
