// Saved, restored into a world built anew, and gone on with: the same bytes.
#include <grapeshot/plugin/state.hpp>

#include <BulletCollision/BroadphaseCollision/btSimpleBroadphase.h>
#include <gmock/gmock.h>

#include <cstring>
#include <type_traits>

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/plugin/detail/body_state.hpp>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

/// As WorldWith, with any broadphase.
template <class Broadphase>
class World {
  public:
    explicit World(const Settings& settings = {}) {
        EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
        world.setGravity({0, -9.81_s, 0});
        world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    }
    ~World() {
        for (auto& body : bodies) {
            world.removeRigidBody(body.get());
        }
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    btRigidBody& add(btCollisionShape& shape, const btTransform& pose, btScalar mass = 0) {
        const btVector3 inertia = mass > 0 ? massProperties(&shape, mass).inertia : btVector3(0, 0, 0);
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
        info.m_startWorldTransform = pose;
        bodies.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(bodies.back().get());
        return *bodies.back();
    }
    void step(int count = 1) {
        for (int i = 0; i < count; ++i) {
            world.stepSimulation(1.0_s / 60, 0);
        }
    }
    const StepStatistics& stats() const { return statistics(&dispatcher); }

    btDefaultCollisionConfiguration configuration;
    Dispatcher dispatcher{&configuration};
    Broadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<btRigidBody>> bodies;
};

/// Bumpy balls and tori in a bowl of walls, some rolling on a plane beside it.
struct SavedScene {
    explicit SavedScene(float radius = 0.4F) : ball(scenes::bumpySphere(radius, 0.08F, 5, 10), Kind::mesh, 0.02_s) {
        for (const MeshShape* shape : {&ball, &torus, &floor}) {
            EXPECT_EQ(prebuild(shape->get()), Status::ok);
        }
    }

    MeshShape ball;
    MeshShape torus{scenes::torus(0.4F, 0.15F, 32, 16), Kind::bvh, 0.02_s};
    MeshShape floor{scenes::box({1.5F, 0.5F, 1.5F}, 12), Kind::bvh, 0.02_s};
    btStaticPlaneShape plane{{0, 1, 0}, -1};
    btBoxShape box{{0.3_s, 0.3_s, 0.3_s}};

    template <class AnyWorld>
    void fill(AnyWorld& world) {
        world.add(*floor, at({0, -0.5_s, 0}));
        world.add(plane, at({0, 0, 0}));
        for (int i = 0; i < 8; ++i) {
            world.add(
                *(i % 2 == 0 ? ball : torus),
                at({0.5_s * btScalar(i % 3) - 0.5_s, 0.6_s + 0.45_s * btScalar(i), 0.4_s * btScalar(i % 4) - 0.6_s},
                   btQuaternion({1, 0.3_s, 0.1_s}, btScalar(i))),
                1 + btScalar(i % 3));
        }
        btRigidBody& roller = world.add(*ball, at({3, -0.5_s, 0}), 1);
        roller.setLinearVelocity({0, 0, 1});
    }
};

template <class AnyWorld>
std::vector<std::byte> saved(AnyWorld& world) {
    std::vector<std::byte> bytes;
    EXPECT_EQ(saveState(&world.world, bytes), Status::ok);
    EXPECT_FALSE(bytes.empty());
    return bytes;
}

template <class AnyWorld>
std::vector<std::uint64_t> trace(AnyWorld& world, int steps) {
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < steps; ++i) {
        world.step();
        hashes.push_back(hashOf(world));
    }
    return hashes;
}

template <class Broadphase>
void expectSameAfter(const Settings& settings, int before, int after) {
    SavedScene scene;
    World<Broadphase> whole(settings);
    scene.fill(whole);
    whole.step(before);
    const std::vector<std::byte> bytes = saved(whole);
    const int manifolds = whole.dispatcher.getNumManifolds();
    const std::vector<std::uint64_t> expected = trace(whole, after);
    EXPECT_GT(manifolds, 0);

    World<Broadphase> again(settings);
    scene.fill(again);
    ASSERT_EQ(restoreState(&again.world, bytes), Status::ok);
    EXPECT_EQ(again.dispatcher.getNumManifolds(), manifolds);
    if (std::is_same_v<Broadphase, btSimpleBroadphase>) {  // the other may know of pairs that have parted
        EXPECT_TRUE(saved(again) == bytes) << "what was restored is not what was saved";
    }
    EXPECT_EQ(trace(again, after), expected);
}

TEST(State, GoesOnWithTheSameBytes) {
    expectSameAfter<btSimpleBroadphase>({}, 100, 150);
}

TEST(State, GoesOnWithTheSameBytesUnderABudget) {
    Settings settings;
    for (const std::uint64_t work : {60U, 300U}) {
        settings.frameBudget.work = work;
        expectSameAfter<btSimpleBroadphase>(settings, 100, 150);
    }
}

TEST(State, GoesOnWithTheSameBytesOnTheTreesOfBulletsBroadphase) {
    // Of this scene, whose parted pairs do not come back. Under a budget they were seen to change a later step.
    expectSameAfter<btDbvtBroadphase>({}, 100, 150);
}

TEST(State, GoesOnWithTheSameBytesByScfWithWhatItTracks) {
    Settings settings;
    settings.method = Method::scf;
    settings.searchWork = 200;
    expectSameAfter<btSimpleBroadphase>(settings, 100, 60);
    settings.frameBudget.work = 1500;
    expectSameAfter<btSimpleBroadphase>(settings, 100, 60);
}

TEST(State, GoesOnOnAnotherNumberOfThreads) {
    SavedScene scene;
    Settings settings;
    settings.frameBudget.work = 200;
    World<btSimpleBroadphase> whole(settings);
    scene.fill(whole);
    whole.step(50);
    const std::vector<std::byte> bytes = saved(whole);
    const std::vector<std::uint64_t> expected = trace(whole, 60);
    for (const int threads : {2, 4}) {
        settings.threads = threads;
        World<btSimpleBroadphase> again(settings);
        scene.fill(again);
        ASSERT_EQ(restoreState(&again.world, bytes), Status::ok);
        EXPECT_EQ(trace(again, 60), expected) << threads;
    }
}

TEST(State, WithoutItsMemoryAPileGoesAnotherWay) {
    // Only poses and velocities, as a program can restore them by itself: not the same bytes, so the rest is needed.
    SavedScene scene;
    World<btSimpleBroadphase> whole;
    scene.fill(whole);
    whole.step(100);
    World<btSimpleBroadphase> again;
    scene.fill(again);
    for (std::size_t i = 0; i < whole.bodies.size(); ++i) {
        apply(detail::stateOf(*whole.bodies[i]), *again.bodies[i]);
    }
    ASSERT_EQ(hashOf(again), hashOf(whole));
    EXPECT_NE(trace(again, 30), trace(whole, 30));
}

TEST(State, GoesOnFromAnyStep) {
    Settings settings;
    settings.frameBudget.work = 100;
    for (const int before : {1, 7, 33, 61}) {
        expectSameAfter<btSimpleBroadphase>(settings, before, 30);
    }
}

TEST(State, ALastSearchUnderWayIsSavedToo) {
    SavedScene scene;
    Settings settings;
    settings.frameBudget.work = 0;
    World<btSimpleBroadphase> world(settings);
    scene.fill(world);
    world.step(40);
    ASSERT_GT(world.stats().degraded, 3);
    const std::size_t withSearches = saved(world).size();
    settings.frameBudget = {};
    ASSERT_EQ(registerAlgorithms(&world.dispatcher, settings), Status::ok);
    World<btSimpleBroadphase> rich;
    scene.fill(rich);
    ASSERT_EQ(restoreState(&rich.world, saved(world)), Status::ok);
    EXPECT_GT(withSearches, 1000U);
    rich.step();
    EXPECT_EQ(rich.stats().degraded, 0);
}

TEST(State, TheStepGoesOnToo) {
    SavedScene scene;
    World<btSimpleBroadphase> world;
    scene.fill(world);
    world.step(25);
    World<btSimpleBroadphase> again;
    scene.fill(again);
    ASSERT_EQ(restoreState(&again.world, saved(world)), Status::ok);
    again.step();
    EXPECT_EQ(again.stats().step, 26U);
    EXPECT_EQ(again.stats().pairs.size(), [&] {
        world.step();
        return world.stats().pairs.size();
    }());
}

TEST(State, SleepForcesAndVelocitiesComeBack) {
    SavedScene scene;
    World<btSimpleBroadphase> world;
    scene.fill(world);
    world.step(10);
    btRigidBody& sleeper = *world.bodies[3];
    sleeper.forceActivationState(ISLAND_SLEEPING);
    sleeper.setDeactivationTime(1.5_s);
    world.bodies[4]->applyCentralForce({1, 2, 3});
    world.bodies[4]->applyTorque({3, 2, 1});
    World<btSimpleBroadphase> again;
    scene.fill(again);
    ASSERT_EQ(restoreState(&again.world, saved(world)), Status::ok);
    EXPECT_EQ(again.bodies[3]->getActivationState(), ISLAND_SLEEPING);
    EXPECT_EQ(again.bodies[3]->getDeactivationTime(), 1.5_s);
    EXPECT_EQ(again.bodies[4]->getTotalForce(), world.bodies[4]->getTotalForce());
    EXPECT_EQ(again.bodies[4]->getTotalTorque(), world.bodies[4]->getTotalTorque());
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        EXPECT_EQ(again.bodies[i]->getLinearVelocity(), world.bodies[i]->getLinearVelocity());
        EXPECT_EQ(again.bodies[i]->getInvInertiaTensorWorld(), world.bodies[i]->getInvInertiaTensorWorld());
        EXPECT_EQ(again.bodies[i]->getInterpolationWorldTransform(), world.bodies[i]->getInterpolationWorldTransform());
    }
}

TEST(State, RewindsAWorldThatHasGoneOn) {
    SavedScene scene;
    World<btSimpleBroadphase> world;
    scene.fill(world);
    world.step(60);
    const std::vector<std::byte> bytes = saved(world);
    const std::vector<std::uint64_t> first = trace(world, 60);
    ASSERT_EQ(restoreState(&world.world, bytes), Status::ok);
    EXPECT_EQ(trace(world, 60), first);
}

TEST(State, AlgorithmsOfOthersBeginAnewButNothingFails) {
    SavedScene scene;
    World<btSimpleBroadphase> world;
    scene.fill(world);
    btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &scene.box, {1, 1, 1});
    info.m_startWorldTransform = at({6, -0.69_s, 0});
    btRigidBody box(info);
    world.world.addRigidBody(&box);
    world.step(30);
    const std::vector<std::byte> bytes = saved(world);
    world.step(5);
    ASSERT_EQ(restoreState(&world.world, bytes), Status::ok);
    world.step(60);
    EXPECT_NEAR(box.getWorldTransform().getOrigin().y(), -0.7, 0.02);
    world.world.removeRigidBody(&box);
}

struct Refused : testing::Test {
    SavedScene scene;
    World<btSimpleBroadphase> world;
    std::vector<std::byte> bytes;
    std::uint64_t before = 0;

    Refused() {
        Settings settings;
        settings.frameBudget.work = 60;
        EXPECT_EQ(registerAlgorithms(&world.dispatcher, settings), Status::ok);
        scene.fill(world);
        world.step(40);
        bytes = saved(world);
        world.step(5);
        before = hashOf(world);
    }
    /// And nothing has changed.
    void expect(std::span<const std::byte> wrong, Status status) {
        const std::vector<std::byte> now = saved(world);
        EXPECT_EQ(restoreState(&world.world, wrong), status);
        EXPECT_EQ(hashOf(world), before);
        EXPECT_TRUE(saved(world) == now);
    }
};

TEST_F(Refused, TruncatedBytes) {
    for (std::size_t size = 0; size < bytes.size(); size += size < 128 ? 1 : 397) {
        ASSERT_EQ(restoreState(&world.world, std::span(bytes).first(size)), Status::badState) << size;
    }
    expect(std::span(bytes).first(bytes.size() - 1), Status::badState);
    std::vector<std::byte> longer = bytes;
    longer.push_back({});
    expect(longer, Status::badState);
}

TEST_F(Refused, ForeignAndChangedBytes) {
    const std::vector<std::byte> noise(10000, std::byte{0x5a});
    expect(noise, Status::badState);
    for (const std::size_t at : {0U, 8U, 12U, 16U, 24U, 40U, 1000U}) {
        std::vector<std::byte> changed = bytes;
        changed[at] ^= std::byte{1};
        expect(changed, Status::badState);
    }
}

/// With a hash that fits, as somebody who means harm would write.
std::vector<std::byte> sealed(std::vector<std::byte> bytes) {
    constexpr std::size_t header = 40;
    const ContentKey key = contentKey(std::span<const std::byte>(bytes).subspan(header));
    std::memcpy(bytes.data() + 24, &key, sizeof key);
    return bytes;
}

TEST_F(Refused, WildNumbersBehindAHashThatFits) {
    int refused = 0;
    for (std::size_t at = 40; at + 4 < bytes.size(); at += 211) {
        for (const std::uint32_t number : {0xffffffffU, 0x7fc00000U, 77U}) {
            std::vector<std::byte> changed = bytes;
            std::memcpy(changed.data() + at, &number, sizeof number);
            World<btSimpleBroadphase> other;
            Settings settings;
            settings.frameBudget.work = 60;
            ASSERT_EQ(registerAlgorithms(&other.dispatcher, settings), Status::ok);
            scene.fill(other);
            const Status status = restoreState(&other.world, sealed(changed));
            EXPECT_THAT(status, testing::AnyOf(Status::ok, Status::badState, Status::otherWorld));
            refused += status == Status::ok ? 0 : 1;
            other.step();  // whatever it is now, nothing crashes
        }
    }
    EXPECT_GT(refused, 10);
}

TEST_F(Refused, OtherWorlds) {
    World<btSimpleBroadphase> empty;
    EXPECT_EQ(restoreState(&empty.world, bytes), Status::otherWorld);
    World<btSimpleBroadphase> fewer;
    scene.fill(fewer);
    fewer.world.removeRigidBody(fewer.bodies.back().get());
    fewer.bodies.pop_back();
    EXPECT_EQ(restoreState(&fewer.world, bytes), Status::otherWorld);
    SavedScene larger(0.45F);
    World<btSimpleBroadphase> other;
    larger.fill(other);
    EXPECT_EQ(restoreState(&other.world, bytes), Status::otherWorld);
    world.bodies[2]->setCollisionShape(scene.torus.get());
    world.bodies[3]->setCollisionShape(scene.ball.get());
    expect(bytes, Status::otherWorld);
}

/// A ball, whose tree is there, on a floor too large for one frame.
struct Late {
    explicit Late(int cells) : floor(scenes::grid(3, 3, 60, cells), Kind::bvh, 0.02_s) {
        EXPECT_EQ(prebuild(ball.get()), Status::ok);
    }
    MeshShape ball{scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s};
    MeshShape floor;

    void fill(World<btSimpleBroadphase>& world) const {
        Settings settings;
        settings.frameBudget.work = 500;
        ASSERT_EQ(registerAlgorithms(&world.dispatcher, settings), Status::ok);
        world.add(*floor, at({0, 0, 0}));
        world.add(*ball, at({0.1_s, 0.55_s, 0.2_s}), 1).setActivationState(DISABLE_DEACTIVATION);
    }
};

TEST(State, AWorldThatStillBuildsIsSavedWhenItsTreesAreThere) {
    const Late scene(71);
    World<btSimpleBroadphase> whole;
    scene.fill(whole);
    whole.step(3);
    ASSERT_EQ(whole.stats().degraded, 1) << "a stand-in";
    std::vector<std::byte> bytes(3);
    EXPECT_EQ(saveState(&whole.world, bytes), Status::stillBuilding);
    EXPECT_TRUE(bytes.empty());
    ASSERT_EQ(prebuild(scene.floor.get()), Status::ok);
    EXPECT_EQ(saveState(&whole.world, bytes), Status::stillBuilding) << "what the pair knows is the stand-in's";
    whole.step();
    bytes = saved(whole);
    const std::vector<std::uint64_t> expected = trace(whole, 60);
    World<btSimpleBroadphase> again;
    scene.fill(again);
    ASSERT_EQ(restoreState(&again.world, bytes), Status::ok);
    EXPECT_EQ(trace(again, 60), expected);
}

TEST(State, RestoringFinishesWhatIsBeingBuilt) {
    std::vector<std::byte> bytes;
    std::vector<std::uint64_t> expected;
    {
        const Late scene(73);
        ASSERT_EQ(prebuild(scene.floor.get()), Status::ok);
        World<btSimpleBroadphase> whole;
        scene.fill(whole);
        whole.step(40);
        bytes = saved(whole);
        expected = trace(whole, 60);
    }
    const Late scene(73);
    World<btSimpleBroadphase> again;
    scene.fill(again);
    again.step(2);
    ASSERT_EQ(again.stats().degraded, 1) << "even a tree that is in the cache takes some frames to be found";
    ASSERT_EQ(restoreState(&again.world, bytes), Status::ok);
    EXPECT_TRUE(saved(again) == bytes);
    EXPECT_EQ(trace(again, 60), expected);
}

TEST(State, ErrorsHaveNames) {
    std::vector<std::byte> bytes(3);
    EXPECT_EQ(saveState(nullptr, bytes), Status::nullPointer);
    EXPECT_TRUE(bytes.empty());
    EXPECT_EQ(restoreState(nullptr, bytes), Status::nullPointer);
    TestWorld world({}, false);
    EXPECT_EQ(saveState(&world.world, bytes), Status::notRegistered);
    EXPECT_EQ(restoreState(&world.world, bytes), Status::notRegistered);
}

}  // namespace
}  // namespace grapeshot::test
