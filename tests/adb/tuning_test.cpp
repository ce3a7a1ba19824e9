// What a mesh teaches about itself, and what it is good for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <grapeshot/adb/augment.hpp>
#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tuning.hpp>
#include <support/fault_of.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

/// Of estimates stopped after so many steps, over Zachmann's poses.
struct Quality {
    double brier = 0;   ///< mean of (probability - truth)^2
    double excess = 0;  ///< mean of probability - truth
};
Quality qualityOf(const Tree& tree, std::uint64_t steps) {
    Query exact(tree, tree);
    Query stopped(tree, tree);
    const DecideSettings endless{.estimateSteps = unlimited, .acceptAt = 1, .rejectAt = 0, .tryWitness = false};
    const std::vector<Pose> poses = zachmannPoses(tree, tree, 12, static_cast<int>(sampleSize(60, 600)), 97).poses;
    Quality quality;
    for (const Pose& pose : poses) {
        const double truth = exact.decide(pose, DecideSettings::exact()).collides ? 1 : 0;
        const Decision decision = stopped.decide(pose, endless, {.work = steps});
        const double probability = decision.collides ? decision.probability : 1.0 - decision.probability;
        quality.brier += (probability - truth) * (probability - truth) / static_cast<double>(poses.size());
        quality.excess += (probability - truth) / static_cast<double>(poses.size());
    }
    return quality;
}

TEST(Tuning, MakesProbabilitiesTrueOnTheMesh) {
    for (const std::uint64_t steps : {1U, 2U, 4U}) {
        SCOPED_TRACE(steps);
        Quality plain;
        Quality tuned;
        int moved = 0;
        for (const scenes::Mesh& mesh :
             {scenes::bumpySphere(1, 0.25F, 6, 12), scenes::torusKnot(3, 4, 1, 0.5F, 0.17F, 160, 12),
              scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2)}) {
            Tree tree = build(mesh.view());
            moved += std::abs(std::log2(tree.stepRates[std::min<std::size_t>(steps - 1, 2)])) > 0.25F ? 1 : 0;
            const Quality with = qualityOf(tree, steps);
            tune(tree, 0);
            const Quality without = qualityOf(tree, steps);
            tuned.brier += with.brier;
            plain.brier += without.brier;
            tuned.excess += std::abs(with.excess);
            plain.excess += std::abs(without.excess);
        }
        EXPECT_GT(moved, 0);
        EXPECT_LT(tuned.brier, plain.brier);
        EXPECT_LT(tuned.excess, 0.6 * plain.excess);
    }
}

TEST(Tuning, IsTheSameHoweverItIsAskedFor) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 12);
    const Tree built = build(mesh.view());
    Tree later = build(mesh.view(), {.tuningPoses = 0});
    EXPECT_EQ(later.stepRates, Tree().stepRates);
    tune(later, BuildSettings().tuningPoses);
    EXPECT_EQ(later.stepRates, built.stepRates);
    tune(later, BuildSettings().tuningPoses);  // what it was tuned to before does not count
    EXPECT_EQ(later.stepRates, built.stepRates);
    tune(later, 0);
    EXPECT_EQ(later.stepRates, Tree().stepRates);
}

TEST(Tuning, HasNoUnit) {
    const scenes::Mesh mesh = scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2);
    const auto rates = build(mesh.view()).stepRates;
    for (const float factor : {0x1p-12F, 0x1p12F}) {
        scenes::Mesh scaled = mesh;
        for (Eigen::Vector3f& vertex : scaled.vertices) {
            vertex *= factor;
        }
        EXPECT_EQ(build(scaled.view()).stepRates, rates) << factor;
    }
}

TEST(Tuning, StaysInItsRangeOnAnyMesh) {
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        Tree tree = build(kind.mesh.view(), {.tuningPoses = 0});
        tune(tree, 64);
        EXPECT_TRUE(findings(tree).empty());
    }
    scenes::Mesh copies = scenes::bumpySphere(1, 0.25F, 6, 2);
    copies.triangles.assign(5000, copies.triangles[0]);
    EXPECT_TRUE(findings(build(copies.view())).empty());
}

TEST(Tuning, BadSettingsAreNamed) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 2);
    for (const int poses : {-1, 10'001}) {
        EXPECT_EQ(faultOf([&] { static_cast<void>(build(mesh.view(), {.tuningPoses = poses})); }), Fault::badSetting);
        Tree tree = build(mesh.view());
        const auto before = tree.stepRates;
        EXPECT_EQ(faultOf([&] { tune(tree, poses); }), Fault::badSetting);
        EXPECT_EQ(tree.stepRates, before);
    }
}

/// A colliding pose that the estimate leaves open, and that takes another number of steps without it.
Pose openPose(const Tree& tree) {
    for (const Pose& pose : grazingPoses(tree, tree, 60, -0.004, 5)) {
        Query query(tree, tree);
        Query exact(tree, tree);
        const Decision truth = exact.decide(pose, DecideSettings::exact());
        const Decision decision = query.decide(pose);
        if (truth.collides && decision.certain && decision.work != truth.work) {
            return pose;
        }
    }
    return {};
}

TEST(AdaptiveDecisions, LeaveOutEstimatesThatSaveNothing) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 12);
    const Tree tree = build(mesh.view());
    const Pose pose = openPose(tree);
    Query exactly(tree, tree);
    const Decision exact = exactly.decide(pose, DecideSettings::exact());
    ASSERT_TRUE(exact.collides);
    DecideSettings settings;
    settings.tryWitness = false;
    Query adaptive(tree, tree);
    int leftOut = 0;
    for (int i = 0; i < 80; ++i) {
        const Decision decision = adaptive.decide(pose, settings);
        EXPECT_EQ(decision.collides, exact.collides);
        EXPECT_TRUE(decision.certain);
        leftOut += decision.work == exact.work ? 1 : 0;
        EXPECT_TRUE(i >= 8 || decision.work != exact.work) << i;
    }
    EXPECT_EQ(leftOut, 68);  // fifteen of sixteen, of 72

    // Where the budget is limited the estimate is what there is when it ends.
    const Decision stopped = adaptive.decide(pose, settings, {.work = 2});
    EXPECT_NE(stopped.probability, 0.5F);

    settings.adaptive = false;
    Query steady(tree, tree);
    for (int i = 0; i < 20; ++i) {
        EXPECT_NE(steady.decide(pose, settings).work, exact.work);
    }
}

TEST(AdaptiveDecisions, EstimateAgainAfterOneThatSettled) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 12);
    const Tree tree = build(mesh.view());
    const Pose open = openPose(tree);
    Pose sure;
    sure.translation = {0.6F * tree.radius, 0, 0};
    Query query(tree, tree);
    DecideSettings settings;
    settings.tryWitness = false;
    ASSERT_EQ(query.decide(sure, settings).stop, StopReason::probability);
    for (int i = 0; i < 40; ++i) {
        query.decide(open, settings);
    }
    int certain = 0;
    int settled = 0;
    for (int i = 0; i < 30; ++i) {
        const Decision decision = query.decide(sure, settings);
        EXPECT_TRUE(decision.collides);
        (decision.certain ? certain : settled) += 1;
    }
    EXPECT_LE(certain, 15);
    EXPECT_GE(settled, 15);
}

}  // namespace
}  // namespace grapeshot::test
