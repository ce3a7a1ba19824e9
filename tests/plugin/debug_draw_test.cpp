// What is drawn, where and in which colour.
#include <grapeshot/plugin/debug_draw.hpp>

#include <gmock/gmock.h>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

struct Recorder : btIDebugDraw {
    struct Box {
        btVector3 lower, upper;  // world frame, of its corners
        btVector3 color;
    };
    struct Contact {
        btVector3 position, normal;
        btScalar distance = 0;
        btVector3 color;
    };
    struct Line {
        btVector3 from, to, color;
    };
    void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override {
        lines.push_back({from, to, color});
    }
    void drawBox(const btVector3& lower, const btVector3& upper, const btTransform& pose,
                 const btVector3& color) override {
        Box box{pose * lower, pose * lower, color};
        for (int corner = 1; corner < 8; ++corner) {
            const btVector3 at =
                pose * btVector3((corner & 1) != 0 ? upper.x() : lower.x(), (corner & 2) != 0 ? upper.y() : lower.y(),
                                 (corner & 4) != 0 ? upper.z() : lower.z());
            box.lower.setMin(at);
            box.upper.setMax(at);
        }
        boxes.push_back(box);
    }
    void drawContactPoint(const btVector3& point, const btVector3& normal, btScalar distance, int,
                          const btVector3& color) override {
        contacts.push_back({point, normal, distance, color});
    }
    void reportErrorWarning(const char*) override {}
    void draw3dText(const btVector3&, const char*) override {}
    void setDebugMode(int wanted) override { mode = wanted; }
    int getDebugMode() const override { return mode; }

    int mode = DBG_DrawAabb | DBG_DrawContactPoints;
    std::vector<Box> boxes;
    std::vector<Contact> contacts;
    std::vector<Line> lines;
};

struct Drawn : testing::Test {
    MeshShape ball{scenes::bumpySphere(0.5F, 0.1F, 5, 12), Kind::mesh, 0.01_s};
    MeshShape floor{scenes::box({3, 0.5F, 3}, 6), Kind::bvh, 0.01_s};
    Settings poor;
    Drawn() { poor.frameBudget.work = 0; }

    void fill(BudgetWorld& world) {
        world.add(*floor, at({7, -0.5_s, 0}));
        world.add(*ball, at({7, 0.5_s, 0}), 1);
    }
};

TEST_F(Drawn, ContactsAreWhereBulletHasThem) {
    BudgetWorld world;
    fill(world);
    world.step(20);
    Recorder recorder;
    ASSERT_EQ(debugDraw(&world.world, &recorder), Status::ok);
    const std::vector<btManifoldPoint> points = world.points();
    ASSERT_GT(points.size(), 0U);
    ASSERT_EQ(recorder.contacts.size(), points.size());
    for (const btManifoldPoint& point : points) {
        const bool found = std::any_of(recorder.contacts.begin(), recorder.contacts.end(), [&](const auto& drawn) {
            return drawn.position == point.m_positionWorldOnB && drawn.normal == point.m_normalWorldOnB &&
                   drawn.distance == point.getDistance() && drawn.color == DebugDrawOptions().certainColor;
        });
        EXPECT_TRUE(found);
    }
    ASSERT_EQ(recorder.lines.size(), 1U);
    EXPECT_EQ(recorder.lines[0].from, world.bodies[0]->getWorldTransform().getOrigin());
    EXPECT_EQ(recorder.lines[0].to, world.bodies[1]->getWorldTransform().getOrigin());
}

TEST_F(Drawn, WhatWasCutShortHasAnotherColour) {
    BudgetWorld world(poor);
    fill(world);
    for (int i = 0; i < 40 && (world.stats().degraded == 0 || world.stats().contacts == 0); ++i) {
        world.step();
    }
    ASSERT_EQ(world.stats().degraded, 1);
    Recorder recorder;
    ASSERT_EQ(debugDraw(&world.world, &recorder), Status::ok);
    ASSERT_GT(recorder.contacts.size(), 0U);
    for (const auto& contact : recorder.contacts) {
        EXPECT_EQ(contact.color, DebugDrawOptions().estimatedColor);
    }
    EXPECT_EQ(recorder.lines.at(0).color, DebugDrawOptions().estimatedColor);
}

TEST_F(Drawn, WhatWaitsForItsTreeToo) {
    const MeshShape late(scenes::grid(3, 3, 60, 67), Kind::bvh, 0.02_s);
    Settings settings;
    settings.frameBudget.work = 5000;
    BudgetWorld world(settings);
    world.add(*late, at({0, 0, 0}));
    world.add(*ball, at({0, 0.55_s, 0}), 1);
    world.step();
    ASSERT_EQ(world.stats().degraded, 1);
    Recorder recorder;
    ASSERT_EQ(debugDraw(&world.world, &recorder), Status::ok);
    EXPECT_GT(recorder.boxes.size(), 2U) << "of the sample";
    ASSERT_EQ(recorder.lines.size(), 1U);
    EXPECT_EQ(recorder.lines[0].color, DebugDrawOptions().estimatedColor);
    world.step();
    EXPECT_EQ(world.stats().degraded, 1) << "drawing has built nothing";
}

TEST_F(Drawn, RefusedPairsTooAndWithinCompounds) {
    btCompoundShape compound;
    compound.addChildShape(at({0, 0.25_s, 0}), ball.get());
    BudgetWorld world;
    world.add(*floor, at({0, -0.5_s, 0}));
    btRigidBody& body = world.add(compound, at({0, 0.25_s, 0}), 1, {1, 1, 1});
    world.step(10);
    Recorder recorder;
    ASSERT_EQ(debugDraw(&world.world, &recorder), Status::ok);
    ASSERT_EQ(recorder.lines.size(), 1U);
    EXPECT_EQ(recorder.lines[0].color, DebugDrawOptions().certainColor);
    EXPECT_EQ(recorder.contacts.size(), world.points().size());
    btTransform stretched = body.getWorldTransform();
    stretched.setBasis(stretched.getBasis().scaled({1.5_s, 1, 1}));
    body.setWorldTransform(stretched);
    world.step();
    Recorder after;
    ASSERT_EQ(debugDraw(&world.world, &after), Status::ok);
    ASSERT_EQ(after.lines.size(), 1U);
    EXPECT_EQ(after.lines[0].color, DebugDrawOptions().refusedColor);
}

TEST_F(Drawn, TreesToALevelAroundTheMesh) {
    BudgetWorld world;
    fill(world);
    world.step();
    std::size_t before = 0;
    for (int level = 0; level < 4; ++level) {
        Recorder recorder;
        DebugDrawOptions options;
        options.treeLevel = level;
        ASSERT_EQ(debugDraw(&world.world, &recorder, options), Status::ok);
        EXPECT_GT(recorder.boxes.size(), before);
        EXPECT_LE(recorder.boxes.size(), 2 * ((std::size_t{1} << 2U * (static_cast<unsigned>(level) + 1U)) - 1) / 3);
        before = recorder.boxes.size();
        btVector3 lower, upper;
        floor->getAabb(world.bodies[0]->getWorldTransform(), lower, upper);
        EXPECT_LT((recorder.boxes[0].lower - lower).length(), 0.05_s);
        EXPECT_LT((recorder.boxes[0].upper - upper).length(), 0.05_s);
        for (const auto& box : recorder.boxes) {
            EXPECT_EQ(box.color, options.treeColor);
            EXPECT_TRUE(box.lower.x() > 3 && box.upper.x() < 11);  // where the bodies are, not their meshes
        }
    }
}

TEST_F(Drawn, ModeAndOptionsAreKept) {
    BudgetWorld world;
    fill(world);
    world.step(20);
    const auto drawn = [&](int mode, const DebugDrawOptions& options) {
        Recorder recorder;
        recorder.mode = mode;
        EXPECT_EQ(debugDraw(&world.world, &recorder, options), Status::ok);
        return std::array{!recorder.boxes.empty(), !recorder.lines.empty(), !recorder.contacts.empty()};
    };
    using Parts = std::array<bool, 3>;
    EXPECT_EQ(drawn(btIDebugDraw::DBG_NoDebug, {}), (Parts{false, false, false}));
    EXPECT_EQ(drawn(btIDebugDraw::DBG_DrawWireframe, {}), (Parts{false, false, false}));
    EXPECT_EQ(drawn(btIDebugDraw::DBG_DrawAabb, {}), (Parts{true, false, false}));
    EXPECT_EQ(drawn(btIDebugDraw::DBG_DrawContactPoints, {}), (Parts{false, true, true}));
    DebugDrawOptions options;
    options.treeLevel = -1;
    options.pairs = false;
    const int both = btIDebugDraw::DBG_DrawAabb | btIDebugDraw::DBG_DrawContactPoints;
    EXPECT_EQ(drawn(both, options), (Parts{false, false, true}));
    options.contacts = false;
    EXPECT_EQ(drawn(both, options), (Parts{false, false, false}));
}

TEST_F(Drawn, ChangesNothingAndBuildsNothing) {
    ASSERT_EQ(prebuild(ball.get()), Status::ok);
    ASSERT_EQ(prebuild(floor.get()), Status::ok);
    const auto run = [&](bool drawing) {
        BudgetWorld world(poor);
        fill(world);
        Recorder recorder;
        for (int i = 0; i < 60; ++i) {
            if (drawing) {
                EXPECT_EQ(debugDraw(&world.world, &recorder), Status::ok);
            }
            world.step();
        }
        return hashOf(world);
    };
    EXPECT_EQ(run(true), run(false));
    const MeshShape apart(scenes::box({0.5F, 0.5F, 0.5F}), Kind::mesh);
    BudgetWorld world;
    world.add(*apart, at({0, 0, 0}), 1);
    Recorder recorder;
    ASSERT_EQ(debugDraw(&world.world, &recorder), Status::ok);
    EXPECT_TRUE(recorder.boxes.empty());  // it has met nobody: there is no tree
}

TEST(DebugDraw, ErrorsHaveNames) {
    Recorder recorder;
    TestWorld world({}, false);
    EXPECT_EQ(debugDraw(nullptr, &recorder), Status::nullPointer);
    EXPECT_EQ(debugDraw(&world.world, nullptr), Status::nullPointer);
    EXPECT_EQ(debugDraw(&world.world, &recorder), Status::notRegistered);
}

}  // namespace
}  // namespace grapeshot::test
