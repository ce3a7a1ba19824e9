// The shadow sees everything and changes nothing.
#include <grapeshot/plugin/shadow.hpp>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <gmock/gmock.h>

#include <optional>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

enum class Theirs { nobody, gimpact, ours };

struct ShadowScene {
    MeshShape torus{scenes::torus(0.4F, 0.15F, 24, 12), Kind::mesh, 0.02_s};
    MeshShape floor{scenes::grid(4, 4, 8, 8), Kind::bvh, 0.02_s};
    btBoxShape box{{0.3_s, 0.3_s, 0.3_s}};
    btCompoundShape compound;
    ShadowScene() { compound.addChildShape(at({0, 0, 0}), torus.get()); }

    void fill(TestWorld& world, Theirs theirs) {
        if (theirs == Theirs::gimpact) {
            btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
        } else if (theirs == Theirs::ours) {
            ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
        }
        world.add(*floor, at({0, 0, 0}));
        for (int i = 0; i < 4; ++i) {
            world.add(*torus, at({0.2_s * btScalar(i), 0.4_s + 0.5_s * btScalar(i), 0}), 1);
        }
        world.add(box, at({2, 0.5_s, 0}), 1);
        world.add(compound, at({-2, 0.5_s, 0}), 1, {1, 1, 1});
    }
};

int addedCalls = 0, startedCalls = 0, endedCalls = 0, processedCalls = 0;
bool countAdded(btManifoldPoint&, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int,
                int) {
    ++addedCalls;
    return false;
}
void onStarted(btPersistentManifold* const&) {
    ++startedCalls;
}
void onEnded(btPersistentManifold* const&) {
    ++endedCalls;
}
bool onProcessed(btManifoldPoint&, void*, void*) {
    ++processedCalls;
    return false;
}

struct Callbacks {
    Callbacks() {
        addedCalls = startedCalls = endedCalls = processedCalls = 0;
        gContactAddedCallback = countAdded;
        gContactStartedCallback = onStarted;
        gContactEndedCallback = onEnded;
        gContactProcessedCallback = onProcessed;
    }
    ~Callbacks() {
        gContactAddedCallback = nullptr;
        gContactStartedCallback = nullptr;
        gContactEndedCallback = nullptr;
        gContactProcessedCallback = nullptr;
    }
};

struct Outcome {
    std::vector<std::uint64_t> hashes;
    std::array<int, 4> callbacks{};
    std::uint64_t work = 0;
    ShadowTotals totals;
};

Outcome run(Theirs theirs, bool shadowed) {
    ShadowScene scene;
    TestWorld world({}, false);
    scene.fill(world, theirs);
    for (auto& body : world.bodies) {
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    }
    const Callbacks callbacks;
    std::optional<Shadow> shadow;
    if (shadowed) {
        shadow.emplace();
    }
    Outcome result;
    for (int i = 0; i < 300; ++i) {
        world.step();
        if (shadow) {
            EXPECT_EQ(shadow->observe(&world.world), Status::ok);
        }
        result.hashes.push_back(hashOf(world));
        result.work += world.stats().work;
    }
    if (shadow) {
        result.totals = shadow->totals();
        shadow.reset();
    }
    result.callbacks = {addedCalls, startedCalls, endedCalls, processedCalls};
    return result;
}

class Shadowed : public testing::TestWithParam<Theirs> {};

TEST_P(Shadowed, TheSimulationIsTheSameBitByBit) {
    const Outcome with = run(GetParam(), true);
    const Outcome without = run(GetParam(), false);
    EXPECT_EQ(with.hashes, without.hashes);
    EXPECT_EQ(with.callbacks, without.callbacks);
    EXPECT_EQ(with.work, without.work);
    EXPECT_EQ(with.totals.steps, 300U);
    EXPECT_GT(with.totals.pairs, 300U);
    EXPECT_GT(with.totals.work, 0U);
    EXPECT_GT(with.totals.ourTime.count(), 0);
    EXPECT_GT(with.totals.bothTouch + with.totals.onlyOurs, 20U);  // where nobody else does, all fall through
    EXPECT_EQ(with.totals.refused, 0U);
}

std::string nameOf(const testing::TestParamInfo<Theirs>& info) {
    constexpr std::array names{"nobody", "gimpact", "ours"};
    return names[static_cast<std::size_t>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(All, Shadowed, testing::Values(Theirs::nobody, Theirs::gimpact, Theirs::ours), nameOf);

/// Steps with a stand-in, and poses, of a floor that no cache knows.
std::pair<int, std::vector<std::uint64_t>> late(int cells, bool shadowed) {
    const MeshShape ball(scenes::sphere(0.5F, 6), Kind::mesh, 0.02_s);
    MeshShape floor(scenes::grid(3, 3, 60, 60), Kind::bvh, 0.02_s);
    floor.mesh.vertices[0].y() -= 0.001F * static_cast<float>(cells);  // far from the ball
    EXPECT_EQ(prebuild(ball.get()), Status::ok);
    Settings settings;
    settings.frameBudget.work = 3000;
    BudgetWorld world(settings);
    world.add(*floor, at({0, 0, 0}));
    world.add(*ball, at({0.1_s, 0.55_s, 0.2_s}), 1).setActivationState(DISABLE_DEACTIVATION);
    Shadow shadow;
    int degraded = 0;
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 120; ++i) {
        world.step();
        degraded += world.stats().degraded;
        if (shadowed) {
            EXPECT_EQ(shadow.observe(&world.world), Status::ok);
            EXPECT_EQ(shadow.pairs().size(), 1U);
        }
        hashes.push_back(hashOf(world));
    }
    EXPECT_EQ(shadow.totals().degraded > 0, shadowed);
    return {degraded, hashes};
}

TEST(Shadow, LeavesTreesOnTheirWayAlone) {
    const auto with = late(1, true);
    const auto without = late(2, false);
    EXPECT_GT(with.first, 10);
    EXPECT_EQ(with.first, without.first);
    EXPECT_EQ(with.second, without.second);
}

TEST(Shadow, SeesEdits) {
    MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::bvh, 0.01_s);
    const MeshShape floor(scenes::box({1.5F, 0.5F, 1.5F}, 2), Kind::bvh, 0.01_s);
    TestWorld world({}, false);
    world.add(*floor, at({0, 0, 0}));
    btRigidBody& body = world.add(*block, at({0, 0.95_s, 0}), 1);
    world.world.setGravity({0, 0, 0});
    world.step();
    Shadow shadow;
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    ASSERT_EQ(shadow.pairs().size(), 1U);
    EXPECT_NEAR(shadow.pairs()[0].ours.depth, 0.07, 0.01);
    for (Eigen::Vector3f& vertex : block.mesh.vertices) {
        vertex.y() *= 0.94F;
    }
    world.step();
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    EXPECT_EQ(body.getWorldTransform().getOrigin().y(), 0.95_s);
    EXPECT_NEAR(shadow.pairs().at(0).ours.depth, 0.04, 0.01);
}

TEST(Shadow, SeesWhatPlainBulletMisses) {
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::bvh, 0.01_s);
    TestWorld world({}, false);
    world.add(*block, at({0, 0, 0}));
    world.add(*block, at({0, 0.95_s, 0}), 1);
    world.step();
    Shadow shadow;
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    ASSERT_EQ(shadow.pairs().size(), 1U);
    const ShadowPair& pair = shadow.pairs()[0];
    EXPECT_EQ(pair.theirs.contacts, 0);
    EXPECT_GE(pair.ours.contacts, 4);
    EXPECT_NEAR(pair.ours.depth, 0.07, 0.01);
    EXPECT_EQ(shadow.totals().onlyOurs, 1U);
    EXPECT_EQ(shadow.totals().onlyTheirs, 0U);
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
    shadow.reset();
    EXPECT_EQ(shadow.totals().pairs, 0U);
}

TEST(Shadow, AgreesWithItself) {
    ShadowScene scene;
    TestWorld world({}, false);
    scene.fill(world, Theirs::ours);
    Shadow shadow;
    for (int i = 0; i < 120; ++i) {
        world.step();
        ASSERT_EQ(shadow.observe(&world.world), Status::ok);
        for (const ShadowPair& pair : shadow.pairs()) {
            EXPECT_EQ(pair.ours.contacts, pair.theirs.contacts);
            EXPECT_EQ(pair.depthDifference, 0);
            EXPECT_EQ(pair.normalAngle, 0);
        }
    }
    EXPECT_GT(shadow.totals().bothTouch, 100U);
    EXPECT_EQ(shadow.totals().onlyOurs + shadow.totals().onlyTheirs, 0U);
}

TEST(Shadow, DepthAndNormalsAreThoseOfGImpactOnAFlatFace) {
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::mesh, 0.01_s);
    const MeshShape floor(scenes::box({2, 0.5F, 2}, 4), Kind::mesh, 0.01_s);
    TestWorld world({}, false);
    btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
    world.add(*floor, at({0, -0.5_s, 0}));
    world.add(*block, at({0.1_s, 0.51_s, 0.2_s}), 1);
    world.world.setGravity({0, 0, 0});
    world.step();
    Shadow shadow;
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    ASSERT_EQ(shadow.pairs().size(), 1U);
    const ShadowPair& pair = shadow.pairs()[0];
    EXPECT_GT(pair.theirs.contacts, 0);
    EXPECT_GT(pair.ours.contacts, 0);
    EXPECT_NEAR(pair.ours.depth, pair.theirs.depth, 0.004);
    EXPECT_LT(pair.normalAngle, 0.1);
    EXPECT_EQ(shadow.totals().bothTouch, 1U);
}

TEST(Shadow, CountsWhatIsCutShortAndRefused) {
    const MeshShape ball(scenes::bumpySphere(0.5F, 0.1F, 5, 14), Kind::mesh, 0.01_s);
    TestWorld world({}, false);
    world.add(*ball, at({0, 0, 0}));
    btRigidBody& upper = world.add(*ball, at({0, 0.95_s, 0}), 1);
    world.step();
    Settings settings;
    settings.pairBudget.work = 2;
    Shadow shadow(settings);
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    EXPECT_EQ(shadow.totals().degraded, 1U);
    EXPECT_LE(shadow.totals().work, 2U);
    btTransform stretched = upper.getWorldTransform();
    stretched.setBasis(stretched.getBasis().scaled({1.5_s, 1, 1}));
    upper.setWorldTransform(stretched);
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    EXPECT_EQ(shadow.totals().refused, 1U);
}

TEST(Shadow, FollowsARegistrationAndBodiesThatGo) {
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::bvh, 0.01_s);
    Shadow shadow;
    TestWorld world({}, false);
    world.add(*block, at({0, 0, 0}));
    for (int round = 0; round < 3; ++round) {
        btRigidBody& body = world.add(*block, at({0, 0.95_s, 0}), 1);
        world.step();
        ASSERT_EQ(shadow.observe(&world.world), Status::ok);
        ASSERT_EQ(shadow.pairs().size(), 1U);
        EXPECT_EQ(shadow.pairs()[0].second, &body);
        EXPECT_EQ(shadow.pairs()[0].theirs.contacts > 0, round > 0);
        world.remove(body);
        if (round == 0) {
            ASSERT_EQ(registerAlgorithms(&world.dispatcher), Status::ok);
        }
    }
    world.step();
    ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    EXPECT_TRUE(shadow.pairs().empty());
}

TEST(Shadow, MayOutliveTheWorld) {
    Shadow shadow;
    const MeshShape block(scenes::box({0.5F, 0.5F, 0.5F}, 2), Kind::bvh, 0.01_s);
    {
        TestWorld world({}, false);
        world.add(*block, at({0, 0, 0}));
        world.add(*block, at({0, 0.95_s, 0}), 1);
        world.step();
        ASSERT_EQ(shadow.observe(&world.world), Status::ok);
    }
    EXPECT_EQ(shadow.totals().onlyOurs, 1U);
}

TEST(Shadow, ErrorsHaveNames) {
    Shadow shadow;
    EXPECT_EQ(shadow.observe(nullptr), Status::nullPointer);
    Settings bad;
    bad.maxManifolds = 0;
    Shadow broken(bad);
    TestWorld world({}, false);
    EXPECT_EQ(broken.observe(&world.world), Status::badSettings);
    EXPECT_EQ(broken.totals().steps, 0U);
}

TEST(Shadow, TextNamesTheNumbers) {
    ShadowTotals totals;
    totals.steps = 2;
    totals.pairs = 7;
    totals.onlyOurs = 3;
    totals.theirTime = std::chrono::microseconds(50);
    EXPECT_THAT(toText(totals), testing::HasSubstr("2 steps, 7 pairs"));
    EXPECT_THAT(toText(totals), testing::HasSubstr("3 only ours"));
    EXPECT_THAT(toText(totals), testing::HasSubstr("25 us theirs"));
}

}  // namespace
}  // namespace grapeshot::test
