// Laws of whole Bullet scenes, through the one line that switches them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <grapeshot/core/instruction_set.hpp>
#include <scenes/world.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

using scenes::Frame;
using scenes::PoseD;
using scenes::World;
using scenes::WorldSettings;

constexpr int steps = 120;
constexpr std::size_t bodies = 6;

PoseD at(double x, double y, double z) {
    return {Eigen::Matrix3d::Identity(), {x, y, z}};
}

/// Six bodies of three kinds fall on a mesh floor and on each other; all of it moved by `motion`.
World makeScene(const WorldSettings& given = {}, const PoseD& motion = {}) {
    WorldSettings settings = given;
    settings.gravity = (motion.rotation * settings.gravity.cast<double>()).eval();
    World world(settings);
    const auto place = [&](const PoseD& pose) -> PoseD {
        return {motion.rotation * pose.rotation, motion.rotation * pose.translation + motion.translation};
    };
    world.addMeshFloor(scenes::grid(4, 4, 8, 8), place({}));
    const std::array kinds{world.addMesh(scenes::bumpySphere(0.5F, 0.12F, 5, 6, 3)),
                           world.addMesh(scenes::cup(0.5F, 0.08F, 0.8F, 16, 5)),
                           world.addMesh(scenes::torus(0.4F, 0.12F, 18, 9))};
    Random random(41);
    for (std::size_t i = 0; i < bodies; ++i) {
        PoseD pose = at(0.35 * static_cast<double>(i % 2), 0.8 + 0.9 * static_cast<double>(i), 0.1 * random.unit());
        pose.rotation = random.rotation().cast<double>();
        world.addBody(kinds[i % kinds.size()], place(pose), 1);
    }
    return world;
}

std::vector<Frame> run(World& world, int count = steps) {
    std::vector<Frame> frames;
    for (int i = 0; i < count; ++i) {
        world.step();
        frames.push_back(world.poses());
    }
    return frames;
}

bool same(const std::vector<Frame>& x, const std::vector<Frame>& y) {
    return std::ranges::equal(x, y, [](const Frame& f, const Frame& g) {
        return std::ranges::equal(f, g, [](const PoseD& p, const PoseD& q) {
            return p.rotation == q.rotation && p.translation == q.translation;
        });
    });
}

TEST(SceneLaws, TheSceneIsRepresentative) {
    World world = makeScene();
    double contacts = 0;
    for (int i = 0; i < steps; ++i) {
        contacts += world.step().contacts;
    }
    EXPECT_GT(contacts / steps, 5);
    const StepStatistics& last = statistics(&world.dispatcher());
    EXPECT_GT(last.pairs.size(), bodies);
    EXPECT_EQ(last.refusals, 0U);
    EXPECT_EQ(last.fallbacks, 0U);
}

TEST(SceneLaws, EveryInstructionSetAndEveryRunGiveTheSameBytes) {
    const InstructionSet best = instructionSet();
    World first = makeScene();
    const std::vector<Frame> reference = run(first);
    for (const InstructionSet set : {best, InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
        limitInstructionSet(set);
        World world = makeScene();
        EXPECT_TRUE(same(run(world), reference)) << name(instructionSet());
    }
    limitInstructionSet(best);
}

TEST(SceneLaws, ABudgetOfWorkGivesTheSameBytesToo) {
    WorldSettings settings;
    settings.settings.pairBudget.work = 12;
    World first = makeScene(settings);
    const std::vector<Frame> reference = run(first);
    World unlimited = makeScene();
    EXPECT_FALSE(same(run(unlimited), reference)) << "the budget is never felt";
    const InstructionSet best = limitInstructionSet(InstructionSet::scalar);
    World again = makeScene(settings);
    EXPECT_TRUE(same(run(again), reference)) << name(best);
    limitInstructionSet(InstructionSet::avx512);
}

class BudgetedScene : public testing::TestWithParam<Method> {};

TEST_P(BudgetedScene, GivesTheSameBytesWhateverTheThreadsAndTheInstructionSet) {
    WorldSettings settings;
    settings.settings.method = GetParam();
    settings.settings.frameBudget.work = GetParam() == Method::scf ? 2500 : 250;
    World first = makeScene(settings);
    int degraded = 0;
    int tracked = 0;
    std::vector<Frame> reference;
    for (int i = 0; i < steps; ++i) {
        first.step();
        const StepStatistics& step = statistics(&first.dispatcher());
        EXPECT_LE(step.work, std::max(step.budget, step.mandatory));
        degraded += step.degraded;
        tracked += step.tracked;
        EXPECT_EQ(step.leftToAdb, 0);
        reference.push_back(first.poses());
    }
    EXPECT_GT(degraded, 20) << "the budget is never felt";
    EXPECT_EQ(tracked > 0, GetParam() == Method::scf);
    for (std::size_t body = 1; body <= bodies; ++body) {
        EXPECT_GT(reference.back()[body].translation.y(), 0) << "body " << body << " has fallen";
    }
    const InstructionSet best = instructionSet();
    for (const InstructionSet set : {best, InstructionSet::scalar, InstructionSet::avx2}) {
        limitInstructionSet(set);
        for (const int threads : {1, 2, 4}) {
            settings.settings.threads = threads;
            World world = makeScene(settings);
            EXPECT_TRUE(same(run(world), reference)) << name(instructionSet()) << ", " << threads << " threads";
        }
    }
    limitInstructionSet(best);
}

INSTANTIATE_TEST_SUITE_P(Methods, BudgetedScene, testing::Values(Method::automatic, Method::scf),
                         [](const auto& method) { return std::string(name(method.param)); });

TEST(SceneLaws, EveryMethodGivesTheSameBytesIfNothingIsLeftOut) {
    World first = makeScene();
    const std::vector<Frame> reference = run(first);
    for (const Method method : {Method::adb, Method::scf}) {
        WorldSettings settings;
        settings.settings.method = method;
        settings.settings.searchWork = unlimited;
        World world = makeScene(settings);
        EXPECT_TRUE(same(run(world), reference)) << name(method);
    }
}

TEST(SceneLaws, SamplesAreTheSameInEveryRunAndOthersWithAnotherSeed) {
    WorldSettings settings;
    settings.settings.method = Method::scf;
    settings.settings.searchWork = 160;
    World first = makeScene(settings);
    int sampled = 0;
    std::vector<Frame> reference;
    std::vector<std::uint64_t> work;
    for (int i = 0; i < steps; ++i) {
        first.step();
        sampled += statistics(&first.dispatcher()).sampled;
        work.push_back(statistics(&first.dispatcher()).work);
        reference.push_back(first.poses());
    }
    EXPECT_GT(sampled, 20) << "nothing is ever sampled";
    const InstructionSet best = limitInstructionSet(InstructionSet::scalar);
    World again = makeScene(settings);
    EXPECT_TRUE(same(run(again), reference));
    limitInstructionSet(best);
    settings.settings.seed = 2;
    World other = makeScene(settings);
    std::vector<std::uint64_t> otherWork;  // what is found may be the same
    for (int i = 0; i < steps; ++i) {
        other.step();
        otherWork.push_back(statistics(&other.dispatcher()).work);
    }
    EXPECT_NE(otherWork, work);
}

TEST(SceneLaws, TwoScenesInTurnsDoNotMeetEachOther) {
    World alone = makeScene();
    const std::vector<Frame> reference = run(alone);
    World one = makeScene();
    World other = makeScene();
    std::vector<Frame> frames;
    for (int i = 0; i < steps; ++i) {
        one.step();
        other.step();
        frames.push_back(one.poses());
    }
    EXPECT_TRUE(same(frames, reference));
}

class SceneLawsByMethod : public testing::TestWithParam<Method> {
  protected:
    static WorldSettings settings() {
        WorldSettings settings;
        settings.settings.method = GetParam();
        return settings;
    }
};
INSTANTIATE_TEST_SUITE_P(Methods, SceneLawsByMethod, testing::Values(Method::automatic, Method::adb, Method::scf),
                         [](const auto& method) { return std::string(name(method.param)); });

/// Moved and turned as a whole, a scene runs the same until rounding has grown. Without friction: Bullet lays the two
/// directions of friction by the world's axes.
TEST_P(SceneLawsByMethod, ARigidMotionOfAllChangesNothing) {
    const PoseD motion{Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {2, -1, 3}};
    WorldSettings smooth = settings();
    smooth.friction = 0;
    World still = makeScene(smooth);
    World moved = makeScene(smooth, motion);
    const std::vector<Frame> a = run(still, 45);
    const std::vector<Frame> b = run(moved, 45);
    double farthest = 0;
    for (std::size_t body = 1; body <= bodies; ++body) {
        const Eigen::Vector3d expected = motion.rotation * a.back()[body].translation + motion.translation;
        farthest = std::max(farthest, (expected - b.back()[body].translation).norm());
    }
    EXPECT_LT(farthest, 2e-3);
    EXPECT_GT((a.back()[1].translation - a.front()[1].translation).norm(), 0.1);
}

/// Poses and velocities are all that a world keeps beside its contacts: a fresh world that is given them goes on nearly
/// like the old one (contacts start without their impulses, which tells most in the middle of an impact: not then).
TEST_P(SceneLawsByMethod, AFreshWorldTakesOver) {
    World old = makeScene(settings());
    run(old, 150);
    World fresh = makeScene(settings());
    for (std::size_t body = 0; body < old.bodies(); ++body) {
        btRigidBody& to = fresh.body(body);
        const btRigidBody& from = old.body(body);
        to.setWorldTransform(from.getWorldTransform());
        to.setInterpolationWorldTransform(from.getWorldTransform());
        to.setLinearVelocity(from.getLinearVelocity());
        to.setAngularVelocity(from.getAngularVelocity());
    }
    const Frame x = run(old, 3).back();
    const Frame y = run(fresh, 3).back();
    for (std::size_t body = 0; body < x.size(); ++body) {
        EXPECT_LT((x[body].translation - y[body].translation).norm(), 0.02);
    }
}

void expectUnharmed(World& world, std::size_t sick) {
    for (int i = 0; i < 60; ++i) {
        world.step();
    }
    const Frame frame = world.poses();
    for (std::size_t body = 1; body < frame.size(); ++body) {
        if (body != sick) {
            EXPECT_TRUE(frame[body].translation.allFinite() && frame[body].rotation.allFinite());
            EXPECT_GT(frame[body].translation.y(), 0) << "body " << body << " has fallen";
        }
    }
    for (int m = 0; m < world.dispatcher().getNumManifolds(); ++m) {
        const btPersistentManifold& manifold = *world.dispatcher().getManifoldByIndexInternal(m);
        for (int p = 0; p < manifold.getNumContacts(); ++p) {
            const btManifoldPoint& point = manifold.getContactPoint(p);
            EXPECT_TRUE(std::isfinite(point.getDistance()) && std::isfinite(point.m_normalWorldOnB.length2()) &&
                        std::isfinite(point.getPositionWorldOnA().length2()));
        }
    }
}

/// Bullet's own broadphase does not survive a NaN in a box, so the pose turns bad where only the narrowphase sees it:
/// between the broadphase and the pairs, as a callback of the program can do.
TEST(BadInput, ANotFinitePoseHarmsNobodyElse) {
    for (const btScalar bad : {std::numeric_limits<btScalar>::quiet_NaN(), std::numeric_limits<btScalar>::infinity()}) {
        World world = makeScene();
        run(world, 40);
        const std::size_t sick = 2;
        btTransform transform = world.body(sick).getWorldTransform();
        transform.setOrigin({bad, 0, 0});
        btOverlappingPairCache& pairs = *world.dynamics().getBroadphase()->getOverlappingPairCache();
        ASSERT_GT(pairs.getNumOverlappingPairs(), 0);
        world.body(sick).setWorldTransform(transform);
        world.dispatcher().dispatchAllCollisionPairs(&pairs, world.dynamics().getDispatchInfo(), &world.dispatcher());
        EXPECT_GT(statistics(&world.dispatcher()).refusals, 0U);
        EXPECT_FALSE(statistics(&world.dispatcher()).lastRefusal.empty());
        world.dynamics().removeRigidBody(&world.body(sick));
        expectUnharmed(world, sick);
        world.dynamics().addRigidBody(&world.body(sick));  // the world takes it out again when it goes
    }
}

/// Programs change scales while a scene runs; zero and mirrored ones among them.
TEST(BadInput, AZeroOrNegativeScaleHarmsNobodyElse) {
    for (const btVector3& scale :
         {btVector3(0, 0, 0), btVector3(1, 0, 1), btVector3(-1, 1, 1), btVector3(-1, -1, -1)}) {
        World world = makeScene();
        // A seventh body, far from the others, with a mesh of its own, on the same floor.
        const std::size_t mesh = world.addMesh(scenes::bumpySphere(0.3F, 0.05F, 4, 4, 9));
        const std::size_t sick = world.addBody(mesh, at(3, 0.5, 3), 1);
        run(world, 20);
        world.body(sick).getCollisionShape()->setLocalScaling(scale);
        expectUnharmed(world, sick);
    }
}

TEST(BadInput, SettingsOutOfRangeAreRefusedAndNothingChanges) {
    World world = makeScene();
    Settings bad;
    bad.maxManifolds = 0;
    EXPECT_EQ(registerAlgorithms(&world.dispatcher(), bad), Status::badSettings);
    bad = {};
    bad.lean = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(registerAlgorithms(&world.dispatcher(), bad), Status::badSettings);
    EXPECT_EQ(registerAlgorithms(nullptr), Status::nullPointer);
    EXPECT_TRUE(isRegistered(&world.dispatcher()));
    World untouched = makeScene();
    EXPECT_TRUE(same(run(world), run(untouched)));
}

}  // namespace
}  // namespace grapeshot::test
