// Soft bodies against each other and themselves in btSoftRigidDynamicsWorld.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include "folded_cloth.hpp"
#include "soft_fixture.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

int belowAfterFalling(bool itself) {
    SoftBudgetWorld world;
    btBoxShape ground({5, 0.5_s, 5});
    world.add(ground, at({0, -0.5_s, 0})).setFriction(1);
    btSoftBody& body = world.add(foldedCloth(world.world.getWorldInfo()), 0.02_s);
    if (itself) {
        EXPECT_EQ(addSelfCollision(&world.dispatcher, &body), Status::ok);
    }
    world.step(sampleSize(120, 600));
    EXPECT_TRUE(isFinite(body));
    if (itself) {
        EXPECT_GT(body.m_scontacts.size(), 0);
        const std::vector<SoftContact> contacts = contactsOf(&world.dispatcher, &body);
        EXPECT_THAT(contacts, testing::Not(testing::IsEmpty()));
        for (const SoftContact& contact : contacts) {
            EXPECT_EQ(contact.other, &body);
            EXPECT_NEAR(contact.otherWeights[0] + contact.otherWeights[1] + contact.otherWeights[2], 1, 1e-5);
        }
        EXPECT_EQ(removeSelfCollision(&world.dispatcher, &body), Status::ok);
        EXPECT_EQ(removeSelfCollision(&world.dispatcher, &body), Status::badArgument);
    }
    return nodesBelowOwnSheet(body);
}

TEST(SoftSoft, FoldedClothStaysAboveItself) {
    EXPECT_LE(belowAfterFalling(true), 1);
    EXPECT_GT(belowAfterFalling(false), 10);  // so that the scene is one
}

struct Sheets {
    explicit Sheets(bool flagged, const Settings& settings = {}) : world(settings) {
        btSoftBodyWorldInfo& info = world.world.getWorldInfo();
        held = cloth(info, {0, 0, 0}, 1, 15, 15, 1);
        falling = cloth(info, {0.1_s, 0.3_s, 0.05_s}, 0.5_s, 11, 0, 0.3_s);
        for (btSoftBody* body : {held, falling}) {
            body->m_cfg.piterations = 4;
            body->m_cfg.collisions |= flagged ? btSoftBody::fCollision::VF_SS : 0;
            world.add(body, 0.02_s);
        }
    }
    SoftTestWorld world;
    btSoftBody* held = nullptr;
    btSoftBody* falling = nullptr;
};

TEST(SoftSoft, OneSheetRestsOnAnother) {
    Sheets sheets(true);
    sheets.world.step(240);
    EXPECT_GT(meanHeight(*sheets.falling), -1);
    EXPECT_LT(fastest(*sheets.falling), 2);
    EXPECT_GT(sheets.world.stats().contacts, 20);
    EXPECT_LT(sheets.world.stats().deepest, 0.04F);  // both margins: nothing has passed
    const ClosestFeatures closest = closestFeatures(*sheets.falling, *sheets.held, 1);
    EXPECT_EQ(closest.status, Status::ok);
    ASSERT_TRUE(closest.found);
    EXPECT_GT(closest.distance, 0.01F);
    EXPECT_LT(closest.distance, 0.06F);
    EXPECT_NEAR((closest.onSoft - closest.onOther).norm(), closest.distance, 1e-4);
}

TEST(SoftSoft, ABudgetThatIsEnoughLeavesNothingOut) {
    std::uint64_t needed = 0;
    for (const bool enough : {true, false}) {
        Settings settings;
        settings.pairBudget.work = enough ? 20'000 : needed / 4;
        Sheets sheets(true, settings);
        int sampled = 0;
        for (int step = 0; step < 240; ++step) {
            sheets.world.step();
            for (const PairStatistics& pair : sheets.world.stats().pairs) {
                EXPECT_FALSE(pair.certain && pair.sampled);
                EXPECT_TRUE(pair.certain || !enough);
                if (pair.sampled) {
                    // Two searches, each of which may end 40 later.
                    EXPECT_LE(pair.work, settings.pairBudget.work + 80);
                    ++sampled;
                }
                needed = std::max(needed, enough ? pair.work : 0);
            }
        }
        EXPECT_TRUE(enough ? sampled == 0 : sampled > 5) << sampled;
        EXPECT_GT(sheets.world.stats().contacts, 5);
        EXPECT_GT(meanHeight(*sheets.falling), -1);
    }
}

TEST(SoftSoft, WithoutTheFlagBodiesDoNotMeet) {
    Sheets sheets(false);
    sheets.world.step(120);
    EXPECT_LT(meanHeight(*sheets.falling), -2);
    EXPECT_EQ(sheets.held->m_scontacts.size() + sheets.falling->m_scontacts.size(), 0);
}

TEST(SoftSoft, DisabledObjectsDoNotMeet) {
    Sheets sheets(true);
    sheets.falling->m_collisionDisabledObjects.push_back(sheets.held);
    sheets.world.step(120);
    EXPECT_LT(meanHeight(*sheets.falling), -2);
}

TEST(SoftSoft, ABodyMayLeaveTheWorldAndOthersGoOn) {
    Sheets sheets(true);
    sheets.world.step(60);
    sheets.world.world.removeSoftBody(sheets.held);
    std::erase_if(sheets.world.softs, [&](const auto& owned) { return owned.get() == sheets.held; });
    sheets.world.step(30);
    EXPECT_TRUE(isFinite(*sheets.falling));
    EXPECT_THAT(contactsOf(&sheets.world.dispatcher, sheets.falling), testing::IsEmpty());
}

double lowest(const btSoftBody& body) {
    double least = 1e9;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        least = std::min(least, static_cast<double>(body.m_nodes[i].m_x.y()));
    }
    return least;
}

/// Cloth that falls on a box, which is Bullet's own to handle, by its tree of nodes.
double heightOnBox(bool ourSolver, bool softPairs) {
    Settings settings;
    settings.softPairs = softPairs;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    EXPECT_EQ(registerAlgorithms(&dispatcher, settings), Status::ok);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    SoftBodySolver ours(&dispatcher);
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration, ourSolver ? &ours : nullptr);
    btSoftBodyWorldInfo& info = world.getWorldInfo();
    info.m_broadphase = &broadphase;
    info.m_dispatcher = &dispatcher;
    info.m_sparsesdf.Initialize();
    btBoxShape box({1, 1, 1});
    btRigidBody ground(0, nullptr, &box);
    world.addRigidBody(&ground);
    const std::unique_ptr<btSoftBody> body(cloth(info, {0, 1.2_s, 0}, 0.8_s, 9, 0, 1));
    body->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    body->getCollisionShape()->setMargin(0.05_s);
    world.addSoftBody(body.get());
    for (int step = 0; step < 60; ++step) {
        world.stepSimulation(1.0_s / 60, 0);
    }
    EXPECT_EQ(body->m_fdbvt.empty(), ourSolver && softPairs);
    const double height = lowest(*body);
    world.removeSoftBody(body.get());
    world.removeRigidBody(&ground);
    EXPECT_EQ(unregisterAlgorithms(&dispatcher), Status::ok);
    return height;
}

TEST(SoftBodySolver, MovesBodiesAsBulletDoesWithoutTheirTreeOfFaces) {
    const double bullets = heightOnBox(false, true);
    EXPECT_GT(bullets, 0.95);
    EXPECT_NEAR(heightOnBox(true, true), bullets, 0.01);
    EXPECT_EQ(heightOnBox(true, false), heightOnBox(false, false));
}

TEST(SoftSoft, RefusesBadArguments) {
    SoftBudgetWorld world;
    btSoftBody& body = world.add(cloth(world.world.getWorldInfo(), {0, 0, 0}, 1, 5, 0, 1), 0.02_s);
    EXPECT_EQ(addSelfCollision(nullptr, &body), Status::nullPointer);
    EXPECT_EQ(addSelfCollision(&world.dispatcher, nullptr), Status::nullPointer);
    EXPECT_EQ(addSelfCollision(&world.dispatcher, &body, {.thickness = -1}), Status::badArgument);
    EXPECT_EQ(addSelfCollision(&world.dispatcher, &body, {.thickness = NAN}), Status::badArgument);
    EXPECT_EQ(addSelfCollision(&world.dispatcher, &body, {.spacing = -1}), Status::badArgument);
    btCollisionDispatcher other(&world.configuration);
    EXPECT_EQ(addSelfCollision(&other, &body), Status::notRegistered);
    EXPECT_EQ(closestFeatures(body, body, 1).status, Status::badArgument);
    EXPECT_EQ(closestFeatures(body, body, -1).status, Status::badArgument);
    btStaticPlaneShape plane({0, 1, 0}, 0);
    btCollisionObject object;
    object.setCollisionShape(&plane);
    EXPECT_EQ(closestFeatures(body, object, 1).status, Status::unsupportedShape);
}

TEST(ClosestFeatures, AlsoOfConvexShapes) {
    SoftTestWorld world;
    btSoftBody& body = world.add(cloth(world.world.getWorldInfo(), {0, 0, 0}, 1, 9, 0, 1), 0.02_s);
    btBoxShape box({0.3_s, 0.2_s, 0.3_s});
    btSphereShape ball(0.25_s);
    btCompoundShape both;
    both.addChildShape(at({0.1_s, 0.7_s, 0}), &box);
    both.addChildShape(at({-0.6_s, 0.4_s, 0.1_s}), &ball);
    btCollisionObject object;
    for (const auto& [shape, height, distance] : {std::tuple<btCollisionShape*, btScalar, float>{&box, 0.5_s, 0.3F},
                                                  {&ball, 0.4_s, 0.15F},
                                                  {&both, 0, 0.15F}}) {
        object.setCollisionShape(shape);
        object.setWorldTransform(at({0, height, 0}));
        const ClosestFeatures closest = closestFeatures(body, object, 1);
        EXPECT_EQ(closest.status, Status::ok);
        ASSERT_TRUE(closest.found);
        EXPECT_NEAR(closest.distance, distance, 1e-3);
        EXPECT_NEAR(closest.onSoft.y(), 0, 1e-3);
        EXPECT_NEAR((closest.onSoft - closest.onOther).norm(), distance, 1e-3);
        EXPECT_GE(closest.nodes[0], 0);
        EXPECT_FALSE(closestFeatures(body, object, distance / 2).found);
    }
    object.setCollisionShape(&ball);
    object.setWorldTransform(at({0.1_s, 0.1_s, 0}));
    EXPECT_EQ(closestFeatures(body, object, 1).distance, 0);
}

}  // namespace
}  // namespace grapeshot::test
