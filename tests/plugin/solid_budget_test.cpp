// Meshes against planes and convex shapes under a budget: cut short, and still held.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

/// Floors of Bullet's own and what lies on them.
struct SolidGround {
    MeshShape ball{scenes::bumpySphere(0.4F, 0.08F, 5, 9), Kind::mesh, 0.02_s};
    MeshShape table{scenes::comb(4, 0.5F, 0.3F, 0.12F), Kind::mesh, 0.02_s};
    MeshShape block{scenes::box({0.35F, 0.2F, 0.35F}, 8), Kind::mesh, 0.02_s};
    btStaticPlaneShape plane{{0, 1, 0}, 0};
    btBoxShape box{{12, 0.5_s, 3}};
    btConvexHullShape hull;
    btSphereShape sphere{0.5_s};
    btCapsuleShapeX capsule{0.4_s, 2};

    SolidGround() {
        for (int corner = 0; corner < 8; ++corner) {
            hull.addPoint(
                {(corner & 1) != 0 ? 12_s : -12_s, (corner & 2) != 0 ? 0.5_s : -0.5_s, (corner & 4) != 0 ? 3_s : -3_s});
        }
        hull.setMargin(0.01_s);
        for (const MeshShape* mesh : {&ball, &table, &block}) {
            EXPECT_EQ(prebuild(mesh->get()), Status::ok);
        }
    }
    [[nodiscard]] std::vector<btCollisionShape*> floors() { return {&plane, &box, &hull}; }

    template <class World>
    void fill(World& world, btCollisionShape& floor) {
        const btScalar top = &floor == &plane ? 0 : &floor == &box ? 0.5_s : 0.51_s;
        world.add(floor, at({0, -top, 0}));
        const std::array shapes{ball.get(), table.get(), block.get()};
        for (int i = 0; i < 9; ++i) {
            btRigidBody& body = world.add(*shapes[static_cast<std::size_t>(i % 3)],
                                          at({2.2_s * btScalar(i) - 9, 0.7_s, 0.1_s * btScalar(i)},
                                             btQuaternion({0.3_s, 1, 0.1_s}, 0.2_s * btScalar(i))),
                                          1);
            body.setActivationState(DISABLE_DEACTIVATION);
        }
        // Convex shapes on meshes.
        world.add(sphere, at({-9, 2.2_s, 0}), 0.5_s, {0.05_s, 0.05_s, 0.05_s});
        world.add(capsule, at({-4.6_s, 2, 0}), 0.5_s, {0.05_s, 0.05_s, 0.05_s});
    }
    template <class World>
    static int lost(const World& world) {
        return static_cast<int>(std::ranges::count_if(world.bodies, [](const auto& body) {
            return body->getInvMass() > 0 && !(body->getWorldTransform().getOrigin().y() > 0.05_s);
        }));
    }
};

TEST(SolidBudget, EnoughIsTheSameAsUnlimited) {
    SolidGround ground;
    for (btCollisionShape* floor : ground.floors()) {
        std::array<std::uint64_t, 2> hashes{};
        for (const bool limited : {false, true}) {
            Settings settings;
            settings.pairBudget.work = limited ? std::uint64_t{1} << 40U : unlimited;
            TestWorld world(settings);
            ground.fill(world, *floor);
            world.step(60);

            EXPECT_EQ(world.stats().degraded, 0);
            hashes[limited ? 1 : 0] = hashOf(world);
        }
        EXPECT_EQ(hashes[0], hashes[1]) << floor->getName();
    }
}

TEST(SolidBudget, IsHeldInEveryStepAndNobodyFallsThrough) {
    SolidGround ground;
    for (btCollisionShape* floor : ground.floors()) {
        for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{100}}) {
            SCOPED_TRACE(std::string(floor->getName()) + ", " + std::to_string(budget));
            Settings settings;
            settings.frameBudget.work = budget;
            BudgetWorld world(settings);
            ground.fill(world, *floor);
            int degraded = 0;
            btScalar fastest = 0;
            for (int i = 0; i < 150; ++i) {
                world.step();
                const StepStatistics& s = world.stats();
                ASSERT_LE(s.work, std::max(s.budget, s.mandatory)) << "step " << i;
                EXPECT_LE(s.mandatory, s.pairs.size() * 88);
                degraded += s.degraded;
                for (const PairStatistics& pair : s.pairs) {
                    EXPECT_LE(pair.work, pair.slice);
                    EXPECT_TRUE(!pair.certain || pair.stop == StopReason::certain);
                }
                if (i > 100) {
                    for (const auto& body : world.bodies) {
                        fastest = btMax(fastest, body->getLinearVelocity().length());
                    }
                }
            }
            EXPECT_GT(degraded, budget == 0 ? 50 : 10);
            EXPECT_EQ(SolidGround::lost(world), 0);
            EXPECT_LT(fastest, 4);
        }
    }
}

TEST(SolidBudget, TheSameBytesOnAnyNumberOfThreads) {
    SolidGround ground;
    std::array<std::uint64_t, 2> hashes{};
    for (const int threads : {1, 2}) {
        Settings settings;
        settings.frameBudget.work = 100;
        settings.threads = threads;
        BudgetWorld world(settings);
        ground.fill(world, ground.hull);
        world.step(60);
        hashes[static_cast<std::size_t>(threads - 1)] = hashOf(world);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(SolidBudget, APairsOwnBudgetIsKeptWithoutADispatcherOfOurs) {
    SolidGround ground;
    for (btCollisionShape* floor : ground.floors()) {
        Settings settings;
        // A leaf costs a unit with Bullet's functions, a quarter of one without.
        const std::uint64_t budget = floor == &ground.hull ? 24 : 8;
        settings.pairBudget.work = budget;
        TestWorld world(settings);
        ground.fill(world, *floor);
        int degraded = 0;
        for (int i = 0; i < 120; ++i) {
            world.step();
            for (const PairStatistics& pair : world.stats().pairs) {
                EXPECT_LE(pair.work, budget);
                degraded += pair.stop == StopReason::budget ? 1 : 0;
            }
        }
        EXPECT_GT(degraded, 20);
        EXPECT_EQ(SolidGround::lost(world), 0) << floor->getName();
    }
}

TEST(SolidBudget, AFastMeshIsStoppedByAThinBoxOnTheMandatorySlices) {
    const MeshShape bullet(scenes::bumpySphere(0.2F, 0.03F, 5, 8), Kind::mesh, 0.005_s);
    btBoxShape wall({0.02_s, 2, 2});
    for (const btScalar speed : {10.0_s, 60.0_s}) {
        Settings settings;
        settings.frameBudget.work = 0;
        BudgetWorld world(settings);
        world.world.setGravity({0, 0, 0});
        world.add(wall, at({0, 0, 0}));
        btRigidBody& body = world.add(*bullet, at({-3.5_s, 0.1_s, 0.05_s}), 1);
        body.setLinearVelocity({speed, 0, 0});
        world.step(60);
        EXPECT_LT(body.getWorldTransform().getOrigin().x(), 0) << speed;
    }
}

}  // namespace
}  // namespace grapeshot::test
