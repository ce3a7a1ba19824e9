#include "scene_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scene_method.hpp"

namespace grapeshot::bench {
namespace {

/// A run of which only energy and sleep are told.
Run runOf(const std::vector<double>& energies, const std::vector<int>& awake) {
    Run run;
    for (std::size_t i = 0; i < energies.size(); ++i) {
        scenes::StepRecord step;
        step.kineticEnergy = 0.25 * energies[i];
        step.potentialEnergy = 0.75 * energies[i];
        step.awake = awake[i];
        run.steps.push_back(step);
        run.stepUs.push_back(awake[i] > 0 ? 10 : 1);
    }
    return run;
}

TEST(SceneQuality, EnergyRisesFromItsLeast) {
    const EnergyCourse course = energyCourse(runOf({100, 60, 75, 70, 40, 45}, {1, 1, 1, 1, 1, 1}));
    EXPECT_DOUBLE_EQ(course.initial, 100);
    EXPECT_DOUBLE_EQ(course.mostRise, 15);
    EXPECT_DOUBLE_EQ(course.mostOverInitial, 0);
    EXPECT_DOUBLE_EQ(energyCourse(runOf({100, 130, 90}, {1, 1, 1})).mostOverInitial, 30);
}

TEST(SceneQuality, WhoWakesUpAgainDidNotSleep) {
    const auto run = runOf({5, 4, 3, 2, 1}, {2, 0, 1, 0, 0});
    EXPECT_EQ(stepsAwake(run), 3U);
    EXPECT_DOUBLE_EQ(secondsToSleep(run, 0.5), 1.5);
    EXPECT_DOUBLE_EQ(awakeMeanUs(run, run.stepUs), 7);
    EXPECT_TRUE(std::isnan(secondsToSleep(runOf({5, 4}, {0, 1}), 0.5)));
}

TEST(SceneQuality, WorkIsTakenFromAWindow) {
    bench::Run run;
    for (const std::uint64_t work : {10U, 20U, 60U, 80U, 30U}) {
        run.work.push_back({.work = work});
    }
    EXPECT_DOUBLE_EQ(meanWork(run, 0.5, 0, 1), 15);
    EXPECT_DOUBLE_EQ(meanWork(run, 0.5, 1, 1), 70);
    EXPECT_DOUBLE_EQ(meanWork(run, 0.5, 2, 5), 30);
    EXPECT_DOUBLE_EQ(meanWork(run, 0.5, 3, 1), 0);
    EXPECT_DOUBLE_EQ(mostWork(run, 0.5, 1), 70);
    EXPECT_DOUBLE_EQ(mostWork(run, 0.5, 0.5), 80);
}

/// A ball in the hollow of a cup, and one that is stuck in its wall.
scenes::World cupAndBall(const scenes::WorldSettings& method, const Eigen::Vector3d& ball) {
    scenes::World world(method);
    world.addBody(world.addMesh(scenes::cup(1, 0.15F, 1.2F, 40, 8)), scenes::PoseD{}, 0);
    world.addBody(world.addMesh(scenes::sphere(0.4F, 8)), {Eigen::Matrix3d::Identity(), ball}, 1);
    return world;
}

TEST(SceneQuality, DepthIsThatOfTheMeshesWhateverCollides) {
    for (const SceneMethod& method :
         {grapeshotMethod(1), hullMethod(1), decimatedMethod(1, 200), hacdMethod(1, {.triangles = 300})}) {
        SCOPED_TRACE(method.name);
        // The hull of the cup is full: for a judge of shapes the ball would be deep in it.
        const scenes::World free = cupAndBall(method.world, {0, 0.3, 0});
        const Depths none = depthsOf(free, {free.poses()});
        EXPECT_EQ(none.bodies, std::vector<double>{0});
        const scenes::World stuck = cupAndBall(method.world, {0.55, 0.3, 0});
        const Depths some = depthsOf(stuck, {stuck.poses(), stuck.poses()});
        ASSERT_EQ(some.bodies.size(), 2U);
        EXPECT_NEAR(some.bodies[0], 0.1, 0.01);
        EXPECT_EQ(some.bodies[0], some.bodies[1]);
    }
}

TEST(SceneMethods, ACompoundHasItsHullsAndLeavesTheHollowFree) {
    const scenes::Mesh mesh = scenes::cup(1, 0.15F, 1.2F, 40, 8);
    const std::shared_ptr<btCollisionShape> shape = hullCompound(mesh, {.hulls = 16, .triangles = 300}, 0.02);
    ASSERT_TRUE(shape->isCompound());
    const auto& compound = static_cast<const btCompoundShape&>(*shape);
    EXPECT_EQ(compound.getNumChildShapes(), 16);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        btVector3 lower;
        btVector3 upper;
        compound.getChildShape(i)->getAabb(btTransform::getIdentity(), lower, upper);
        const bool hasAxis = lower.x() < 0 && upper.x() > 0 && lower.z() < 0 && upper.z() > 0;
        EXPECT_FALSE(hasAxis && upper.y() > 0.3F) << "hull " << i;
    }
}

TEST(SceneMethods, DoWhatTheirNamesSay) {
    EXPECT_EQ(budgeted(grapeshotMethod(1), 500).world.settings.frameBudget.work, 500U);
    EXPECT_EQ(roundRobin(1, 7).world.settings.pairBudget.work, 7U);
    EXPECT_EQ(roundRobin(1, 7).world.settings.frameBudget.work, unlimited);
    EXPECT_DOUBLE_EQ(halvedRate(grapeshotMethod(1)).world.timeStep, 1.0 / 30);
}

}  // namespace
}  // namespace grapeshot::bench
