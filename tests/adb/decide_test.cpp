// `decide` against the slow truth.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <grapeshot/adb/query.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"
#include "trees.hpp"

namespace grapeshot::test {
namespace {

struct Tally {
    int poses = 0;
    int colliding = 0;
    int excused = 0;
};

void expectTruth(const Tree& a, const Tree& b, Query& query, const Pose& pose, Tally& tally) {
    for (const Order order : {Order::depthFirst, Order::bestFirst}) {
        const Decision decision = query.decide(pose, DecideSettings::exact(order));
        ASSERT_TRUE(decision.certain);
        EXPECT_EQ(decision.stop, StopReason::certain);
        EXPECT_EQ(decision.probability, 1);
        ++tally.poses;
        tally.colliding += decision.collides ? 1 : 0;
        if (decision.collides) {
            const double separation = triangleSeparation(cornersOf(a.mesh(), decision.witness.triangleA),
                                                         cornersOf(b.mesh(), decision.witness.triangleB, pose));
            EXPECT_LE(std::abs(trianglesOverlap(cornersOf(a.mesh(), decision.witness.triangleA),
                                                cornersOf(b.mesh(), decision.witness.triangleB, pose))
                                   ? 0
                                   : separation),
                      borderline(a, b, pose));
        } else {
            EXPECT_EQ(decision.witness, TrianglePair());
        }
        if (decision.collides != bruteForceDecide(a.mesh(), b.mesh(), pose)) {
            ++tally.excused;
            EXPECT_LE(std::abs(bruteForceClearance(a.mesh(), b.mesh(), pose)), borderline(a, b, pose));
        }
    }
}

TEST(Decide, IsTrueOnEveryKindAgainstItself) {
    Random random(1);
    Tally tally;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        Query query(tree, tree);
        for (std::size_t i = 0; i < sampleSize(12, 500); ++i) {
            expectTruth(tree, tree, query, randomPose(tree, tree, random), tally);
        }
    }
    EXPECT_GT(tally.colliding, tally.poses * 3 / 10);
    EXPECT_LT(tally.colliding, tally.poses * 9 / 10);
    EXPECT_LE(tally.excused, tally.poses / 100);
}

TEST(Decide, IsTrueOnUnlikePairs) {
    Random random(2);
    Tally tally;
    const std::vector<NamedMesh>& kinds = everyKind();
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const NamedMesh& second = kinds[(i + 5) % kinds.size()];
        SCOPED_TRACE(kinds[i].name + " and " + second.name);
        const Tree a = build(kinds[i].mesh.view());
        const Tree b = build(scenes::scaled(second.mesh, 0.4F).view());
        Query query(a, b);
        for (std::size_t j = 0; j < sampleSize(12, 500); ++j) {
            expectTruth(a, b, query, randomPose(a, b, random), tally);
        }
    }
    EXPECT_GT(tally.colliding, tally.poses * 2 / 10);
    EXPECT_LT(tally.colliding, tally.poses * 9 / 10);
}

TEST(Decide, IsTrueWhereItIsClose) {
    Tally tally;
    for (const char* name : {"torus", "cup", "torus knot", "bumpy sphere"}) {
        for (const NamedMesh& kind : everyKind()) {
            if (kind.name != name) {
                continue;
            }
            const Tree tree = build(kind.mesh.view());
            Query query(tree, tree);
            for (const double gap : {-1e-3, -1e-4, 1e-4, 1e-3}) {
                for (const Pose& pose : grazingPoses(tree, tree, static_cast<int>(sampleSize(5, 200)), gap, 3)) {
                    expectTruth(tree, tree, query, pose, tally);
                }
            }
        }
    }
    EXPECT_GT(tally.colliding, tally.poses / 4);
    EXPECT_LT(tally.colliding, tally.poses * 3 / 4);
}

TEST(Decide, IsTrueAtAllScalesAndFarFromTheOrigin) {
    Random random(4);
    Tally tally;
    const scenes::Mesh sound = scenes::bumpySphere(1, 0.25F, 6, 4);
    for (const float scale : {1e-12F, 1e-6F, 1e6F, 1e12F}) {
        SCOPED_TRACE(scale);
        const Tree tree = build(scenes::scaled(sound, scale).view());
        Query query(tree, tree);
        for (std::size_t i = 0; i < sampleSize(15, 300); ++i) {
            expectTruth(tree, tree, query, randomPose(tree, tree, random), tally);
        }
    }
    // Single precision resolves 0.06 m out there; the triangles are some ten metres long.
    const Tree far = build(scenes::moved(scenes::scaled(sound, 100), {1e6F, 1e6F, -1e6F}).view());
    Query query(far, far);
    for (std::size_t i = 0; i < sampleSize(15, 300); ++i) {
        expectTruth(far, far, query, randomPose(far, far, random), tally);
    }
    EXPECT_GT(tally.colliding, tally.poses * 2 / 10);
    EXPECT_LT(tally.colliding, tally.poses * 9 / 10);
}

TEST(Decide, IsTrueOnDegenerateMeshes) {
    Random random(5);
    Tally tally;
    const Tree single = build(copiesOfOne(1).view());
    const Tree many = build(copiesOfOne(100'000).view());
    const Tree thin = build(needles(200).view());
    const Tree ball = build(scenes::sphere(0.6F, 3).view());
    for (const Tree* a : {&single, &thin, &ball}) {
        for (const Tree* b : {&single, &thin, &ball}) {
            Query query(*a, *b);
            for (std::size_t i = 0; i < sampleSize(15, 300); ++i) {
                expectTruth(*a, *b, query, randomPose(*a, *b, random), tally);
            }
        }
    }
    EXPECT_GT(tally.colliding, tally.poses / 10);
    EXPECT_LT(tally.colliding, tally.poses * 9 / 10);
    Query one(single, single);
    Query stack(single, many);
    for (std::size_t i = 0; i < 50; ++i) {
        const Pose pose = randomPose(single, single, random);
        EXPECT_EQ(stack.decide(pose, DecideSettings::exact()).collides,
                  one.decide(pose, DecideSettings::exact()).collides);
    }
}

TEST(Decide, FindsASmallBodyWhollyInsideClear) {
    // Surfaces, not solids.
    const Tree big = build(scenes::sphere(1, 6).view());
    const Tree small = build(scenes::sphere(0.3F, 3).view());
    Query query(big, small);
    const Decision decision = query.decide(Pose{}, DecideSettings::exact());
    EXPECT_TRUE(decision.certain);
    EXPECT_FALSE(decision.collides);
}

TEST(Decide, FarApartCostsNothing) {
    const Tree tree = build(scenes::sphere(1, 6).view());
    Query query(tree, tree);
    const Decision decision = query.decide({Eigen::Matrix3f::Identity(), {1e30F, 0, 0}}, DecideSettings::exact(), {0});
    EXPECT_TRUE(decision.certain);
    EXPECT_FALSE(decision.collides);
    EXPECT_EQ(decision.work, 0U);
}

TEST(Decide, RefusesWhatIsNoPose) {
    const Tree tree = build(scenes::sphere(1, 3).view());
    Query query(tree, tree);
    std::vector<Pose> bad(5);
    bad[0].rotation(1, 2) = std::numeric_limits<float>::quiet_NaN();
    bad[1].translation[0] = std::numeric_limits<float>::infinity();
    bad[2].rotation *= 1.01F;
    bad[3].rotation(0, 0) = -1;  // a mirror
    bad[4].rotation.setConstant(std::numeric_limits<float>::infinity());
    for (const Pose& pose : bad) {
        const Decision decision = query.decide(pose, DecideSettings::exact());
        EXPECT_EQ(decision.stop, StopReason::invalidInput);
        EXPECT_FALSE(decision.certain);
        EXPECT_EQ(decision.work, 0U);
        EXPECT_EQ(query.resume({}).stop, StopReason::invalidInput);
    }
    EXPECT_TRUE(query.decide(Pose{}, DecideSettings::exact()).certain);
}

TEST(Decide, ABodyNotQuiteRigidIsStillTrue) {
    // Within the tolerance of isRigid, as an integrator leaves it.
    Random random(6);
    Tally tally;
    const Tree tree = build(scenes::torus(1, 0.3F, 20, 8).view());
    Query query(tree, tree);
    for (std::size_t i = 0; i < sampleSize(30, 500); ++i) {
        Pose pose = randomPose(tree, tree, random);
        pose.rotation *= static_cast<float>(random.uniform(0.9998, 1.0002));
        pose.rotation(0, 1) += static_cast<float>(random.uniform(-2e-4, 2e-4));
        expectTruth(tree, tree, query, pose, tally);
    }
    EXPECT_GT(tally.colliding, 0);
}

TEST(Decide, TheLastWitnessIsTriedFirst) {
    const Tree tree = build(scenes::bumpySphere(1, 0.25F, 6, 8).view());
    Query query(tree, tree);
    Pose pose{Eigen::Matrix3f::Identity(), {0.9F, 0.3F, 0.2F}};
    const Decision first = query.decide(pose, DecideSettings::exact());
    ASSERT_TRUE(first.collides);
    EXPECT_GT(first.work, 1U);
    const Decision second = query.decide(pose, DecideSettings::exact());
    EXPECT_EQ(second.work, 1U);
    EXPECT_EQ(second.witness, first.witness);
}

TEST(Decide, AnEstimateKnowsNothingOfTheQueriesBefore) {
    // The same query again and again, and one of its own for each pose, on every instruction set.
    const InstructionSetGuard guard;
    const Tree tree = build(scenes::bumpySphere(1, 0.25F, 6, 10).view());
    DecideSettings settings{.estimateSteps = 16, .acceptAt = 1, .rejectAt = 0.01F, .adaptive = false};
    settings.tryWitness = false;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        Query used(tree, tree);
        for (const Pose& pose : zachmannPoses(tree, tree, 12, static_cast<int>(sampleSize(50, 500)), 12).poses) {
            Query fresh(tree, tree);
            const Decision expected = fresh.decide(pose, settings);
            const Decision decision = used.decide(pose, settings);
            EXPECT_EQ(decision.work, expected.work);
            EXPECT_EQ(decision.probability, expected.probability);
            EXPECT_EQ(decision.collides, expected.collides);
        }
    }
}

TEST(Decide, AnEmptyTreeTouchesNothing) {
    const Tree tree = build(scenes::sphere(1, 3).view());
    const Tree empty;
    Query query(tree, empty);
    EXPECT_FALSE(query.decide(Pose{}, DecideSettings::exact()).collides);
    EXPECT_TRUE(query.contacts(Pose{}, {1}).pairs.empty());
}

}  // namespace
}  // namespace grapeshot::test
