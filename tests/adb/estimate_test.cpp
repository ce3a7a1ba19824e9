// The probabilistic start of a decision: what it is made of, what it must never do, and how often it may be wrong.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/estimate.hpp>
#include <grapeshot/adb/query.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"
#include "pair_cases.hpp"

namespace grapeshot::test {
namespace {

/// None of these meshes is one that the calibration was fitted on.
const std::vector<PairCase>& cases() {
    static const std::vector<PairCase> all =
        pairCases({scenes::bumpySphere(1, 0.25F, 6, 12), scenes::torusKnot(3, 4, 1, 0.5F, 0.17F, 160, 12),
                   scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2)},
                  12, static_cast<int>(sampleSize(40, 1000)), 31);
    return all;
}

DecideSettings toTheEnd() {
    return {.estimateSteps = unlimited, .acceptAt = 1, .rejectAt = 0};
}

/// What a kernel says of two children, from the decoded distributions in double precision.
struct Plain {
    double squaredDistance, length;
};
Plain plainly(const Tree& tree, detail::SidePair parents, int slotA, int slotB, const Pose& pose) {
    const auto surface = [&](detail::Side side, int slot) {
        return surfaceOf(tree.nodes[side], tree.distributions[side], slot);
    };
    const ChildSurface a = surface(detail::sideA(parents), slotA);
    const ChildSurface b = surface(detail::sideB(parents), slotB);
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const Eigen::Vector3d d = rotation * b.mean + pose.translation.cast<double>() - a.mean;
    const Eigen::Matrix3d sum = a.covariance + rotation * b.covariance * rotation.transpose();
    return {d.dot(sum.ldlt().solve(d)), std::log2(a.area * b.area) - 2.0 / 3 * std::log2(sum.determinant())};
}

TEST(Estimate, DistanceAndLengthAreThoseOfTheDistributions) {
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        detail::Descent descent;
        descent.nodesA = descent.nodesB = tree.nodes.data();
        descent.distributionsA = descent.distributionsB = tree.distributions.data();
        Random random(4);
        int compared = 0;
        for (std::size_t i = 0; i < sampleSize(300, 3000); ++i) {
            const Pose pose = randomPose(tree, tree, random);
            if (detail::prepare(pose, tree.radius, tree.radius, 0, descent.prepared) != detail::PoseVerdict::usable) {
                continue;
            }
            const auto node = [&] { return static_cast<detail::Side>(random.bits() % tree.nodes.size()); };
            const detail::SidePair pair = detail::sidePair(node(), i % 2 == 0 ? 0 : node());
            detail::ChildPair children[16];
            const int count = detail::childPairs(descent, pair, children);
            for (int k = 0; k < count; ++k) {
                const auto slotOf = [&](detail::Side parent, detail::Side side) {
                    for (int slot = 0; slot < 4; ++slot) {
                        const ChildRef child = tree.nodes[parent].child[slot];
                        if (isLeaf(child) ? side == (leafBit | parent << 2U | static_cast<detail::Side>(slot))
                                          : side == child) {
                            return slot;
                        }
                    }
                    return -1;
                };
                const int slotA = slotOf(detail::sideA(pair), detail::sideA(children[k].pair));
                const int slotB = slotOf(detail::sideB(pair), detail::sideB(children[k].pair));
                ASSERT_GE(slotA, 0);
                ASSERT_GE(slotB, 0);
                const Plain truth = plainly(tree, pair, slotA, slotB, pose);
                EXPECT_NEAR(children[k].squaredDistance, truth.squaredDistance, 1e-3 + 1e-2 * truth.squaredDistance);
                // The rough logarithm is up to 0.086 too small, and counts two thirds.
                EXPECT_GT(children[k].length, truth.length - 0.01);
                EXPECT_LT(children[k].length, truth.length + 0.07);
                ++compared;
            }
        }
        EXPECT_GT(compared, 20);
    }
}

TEST(Estimate, TheCutLosesNoPair) {
    // The same query again and again: what the last one left in its memory must not matter.
    for (const PairCase& pair : cases()) {
        Query exact(pair.a, pair.b);
        Query estimated(pair.a, pair.b);
        for (const Pose& pose : pair.poses) {
            const bool truth = exact.decide(pose, DecideSettings::exact()).collides;
            for (const std::uint64_t steps : {std::uint64_t{1}, std::uint64_t{5}, std::uint64_t{40}, unlimited}) {
                const Decision decision =
                    estimated.decide(pose, {.estimateSteps = steps, .acceptAt = 1, .rejectAt = 0});
                ASSERT_TRUE(decision.certain);
                ASSERT_EQ(decision.collides, truth) << steps;
                ASSERT_EQ(decision.stop, StopReason::certain);
                ASSERT_EQ(decision.collides, decision.witness != TrianglePair());
            }
        }
    }
}

TEST(Estimate, StoppedAndResumedEndsTheSame) {
    for (const DecideSettings& settings : {DecideSettings(), toTheEnd(), DecideSettings{.estimateSteps = 2}}) {
        for (const PairCase& pair : cases()) {
            Query whole(pair.a, pair.b);
            Query pieces(pair.a, pair.b);
            for (std::size_t i = 0; i < pair.poses.size(); i += 3) {
                const Decision expected = whole.decide(pair.poses[i], settings);
                const std::uint64_t piece = i % 3 + 1;
                Decision decision = pieces.decide(pair.poses[i], settings, {.work = 0});
                EXPECT_EQ(decision.work, 0U);
                while (decision.stop == StopReason::budget) {
                    EXPECT_GE(decision.probability, 0.5F);
                    EXPECT_LT(decision.probability, 1);
                    decision = pieces.resume({.work = piece});
                }
                ASSERT_TRUE(same(decision, expected)) << i;
            }
        }
    }
}

TEST(Estimate, SureEnoughGoesOnUntilCertain) {
    const DecideSettings loose{.estimateSteps = unlimited, .acceptAt = 0.8F, .rejectAt = 0.2F};
    int stoppedEarly = 0;
    for (const PairCase& pair : cases()) {
        Query query(pair.a, pair.b);
        Query exact(pair.a, pair.b);
        for (std::size_t i = 0; i < pair.poses.size(); i += 2) {
            const Decision first = query.decide(pair.poses[i], loose);
            if (first.stop == StopReason::probability) {
                ++stoppedEarly;
                EXPECT_FALSE(first.certain);
                EXPECT_GE(first.probability, 0.79F);
                EXPECT_EQ(first.witness, TrianglePair());
            }
            const Decision last = query.resume({});
            EXPECT_TRUE(last.certain);
            EXPECT_GE(last.work, first.work);
            EXPECT_EQ(last.collides, exact.decide(pair.poses[i], DecideSettings::exact()).collides);
        }
    }
    EXPECT_GT(stoppedEarly, 100);
}

TEST(Estimate, SureEnoughGoesOnInPiecesToo) {
    const DecideSettings loose{.estimateSteps = unlimited, .acceptAt = 0.8F, .rejectAt = 0.2F};
    int stoppedEarly = 0;
    for (const PairCase& pair : cases()) {
        Query query(pair.a, pair.b);
        for (std::size_t i = 0; i < pair.poses.size(); i += 4) {
            Decision decision = query.decide(pair.poses[i], loose);
            stoppedEarly += decision.stop == StopReason::probability ? 1 : 0;
            while (!decision.certain) {
                const Decision next = query.resume({.work = 2});
                ASSERT_NE(next.stop, StopReason::probability);
                ASSERT_GT(next.work, decision.work);
                decision = next;
            }
        }
    }
    EXPECT_GT(stoppedEarly, 50);
}

TEST(Estimate, SettingsOfTheLastQueryDoNotMatter) {
    // Settings alternate on one object; limits that it has worked out for one must not serve another.
    const DecideSettings loose{.estimateSteps = unlimited, .acceptAt = 0.7F, .rejectAt = 0.3F};
    const DecideSettings sequence[] = {loose, DecideSettings::exact(), toTheEnd(), DecideSettings(), loose, toTheEnd()};
    for (const PairCase& pair : cases()) {
        Query shared(pair.a, pair.b);
        for (std::size_t i = 0; i < pair.poses.size(); i += 4) {
            for (DecideSettings settings : sequence) {
                settings.tryWitness = false;
                ASSERT_TRUE(same(shared.decide(pair.poses[i], settings),
                                 Query(pair.a, pair.b).decide(pair.poses[i], settings)));
            }
        }
    }
}

TEST(Estimate, SameBytesOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    for (const PairCase& pair : cases()) {
        for (const DecideSettings& settings : {DecideSettings(), toTheEnd()}) {
            for (const std::uint64_t work : {std::uint64_t{1}, std::uint64_t{3}, std::uint64_t{20}, unlimited}) {
                std::vector<Decision> first;
                for (const InstructionSet set : instructionSets()) {
                    limitInstructionSet(set);
                    Query query(pair.a, pair.b);
                    const bool isFirst = first.empty();
                    for (std::size_t i = 0; i < pair.poses.size(); i += 5) {
                        const Decision decision = query.decide(pair.poses[i], settings, {.work = work});
                        if (isFirst) {
                            first.push_back(decision);
                        } else {
                            ASSERT_TRUE(same(decision, first[i / 5])) << i;
                        }
                    }
                }
            }
        }
    }
}

TEST(Estimate, ACopyGoesOnByItself) {
    const PairCase& pair = cases().front();
    Query original(pair.a, pair.b);
    for (std::size_t i = 0; i < 40; ++i) {
        (void)original.decide(pair.poses[i], toTheEnd(), {.work = 3});
        Query copy = original;
        const Decision ofOriginal = original.resume({});
        (void)original.decide(pair.poses[i + 1], toTheEnd());  // uses its own memory
        ASSERT_TRUE(same(copy.resume({}), ofOriginal));
    }
}

struct Errors {
    int misses = 0, falseAlarms = 0, poses = 0, colliding = 0;
    [[nodiscard]] double percent() const { return 100.0 * (misses + falseAlarms) / poses; }
};
Errors errorsOf(const DecideSettings& settings, Budget budget) {
    Errors out;
    for (const PairCase& pair : cases()) {
        Query exact(pair.a, pair.b);
        Query query(pair.a, pair.b);
        for (const Pose& pose : pair.poses) {
            const bool truth = exact.decide(pose, DecideSettings::exact()).collides;
            const bool answer = query.decide(pose, settings, budget).collides;
            ++out.poses;
            out.colliding += truth ? 1 : 0;
            out.misses += truth && !answer ? 1 : 0;
            out.falseAlarms += !truth && answer ? 1 : 0;
        }
    }
    return out;
}

TEST(Estimate, MoreStepsFewerErrors) {
    const Errors sample = errorsOf(DecideSettings::exact(), {});
    EXPECT_GT(sample.colliding, sample.poses / 4);
    EXPECT_LT(sample.colliding, sample.poses * 9 / 10);
    // The gates are held by `grapeshot_bench anytime`; a small sample may be a little beyond them (2.08 % of 480 poses
    // after four steps).
    EXPECT_LE(errorsOf(toTheEnd(), {.work = 1}).percent(), 8);
    EXPECT_LE(errorsOf(toTheEnd(), {.work = 2}).percent(), 4);
    EXPECT_LE(errorsOf(toTheEnd(), {.work = 4}).percent(), 2.5);
    EXPECT_LE(errorsOf(toTheEnd(), {.work = 8}).percent(), 1);
    EXPECT_LE(errorsOf(toTheEnd(), {.work = 64}).percent(), 0.05);
    EXPECT_LE(errorsOf(DecideSettings(), {}).percent(), 0.05);
}

TEST(Estimate, RefusesBadThresholds) {
    const PairCase& pair = cases().front();
    Query query(pair.a, pair.b);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (const auto& [acceptAt, rejectAt] :
         {std::pair{0.4F, 0.1F}, {1.1F, 0.1F}, {nan, 0.1F}, {-1.0F, 0.1F}, {0.9F, -0.1F}, {0.9F, 0.6F}, {0.9F, nan}}) {
        const Decision decision = query.decide(pair.poses[0], {.acceptAt = acceptAt, .rejectAt = rejectAt});
        EXPECT_EQ(decision.stop, StopReason::invalidInput);
        EXPECT_EQ(decision.work, 0U);
        EXPECT_EQ(query.resume({}).stop, StopReason::invalidInput);
    }
    EXPECT_NE(query.decide(pair.poses[0]).stop, StopReason::invalidInput);
}

TEST(Estimate, OddMeshesHaveADefinedAnswer) {
    std::vector<scenes::Mesh> odd{copiesOfOne(1), copiesOfOne(300), needles(400), scenes::grid(1, 1, 20, 20),
                                  scenes::moved(scenes::sphere(1, 8), {1e6F, -1e6F, 1e6F})};
    for (const float scale : {1e-6F, 1e6F}) {
        odd.push_back(scenes::scaled(scenes::normalised(scenes::bumpySphere(1, 0.2F, 5, 8)), scale));
        odd.push_back(scenes::scaled(needles(300), scale));
    }
    for (std::size_t i = 0; i < odd.size(); ++i) {
        SCOPED_TRACE(i);
        const Tree tree = build(odd[i].view());
        Query exact(tree, tree);
        Query query(tree, tree);
        Random random(8);
        for (std::size_t k = 0; k < sampleSize(40, 400); ++k) {
            const Pose pose = randomPose(tree, tree, random);
            const bool truth = exact.decide(pose, DecideSettings::exact()).collides;
            for (const std::uint64_t work : {std::uint64_t{1}, std::uint64_t{3}}) {
                const Decision decision = query.decide(pose, toTheEnd(), {.work = work});
                EXPECT_TRUE(decision.probability >= 0.5F && decision.probability <= 1);
                EXPECT_EQ(decision.certain, decision.probability == 1);
            }
            EXPECT_EQ(query.resume({}).collides, truth);
        }
    }
}

TEST(Estimate, ManyCopiesOfOneTriangleEndWithTheBudget) {
    const Tree tree = build(copiesOfOne(200'000).view());
    Query query(tree, tree);
    Pose pose;
    // Upright, and beyond the long edge: every box touches every other, and no triangle does.
    pose.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    pose.translation = {0.75F, 0.6F, 0.5F};
    const Decision decision = query.decide(pose, toTheEnd(), {.work = 2000});
    EXPECT_EQ(decision.stop, StopReason::budget);
    EXPECT_EQ(decision.work, 2000U);
    EXPECT_LT(decision.probability, 1);
}

TEST(Estimate, SamplesInTheShareOfTheProbability) {
    Decision decision;
    decision.collides = false;
    decision.probability = 0.7F;
    int yes = 0;
    constexpr int draws = 20'000;
    for (std::uint64_t episode = 0; episode < draws; ++episode) {
        const RandomKey key{1, pairKey(4, 9), episode};
        yes += answerOf(decision, Answer::sample, key) ? 1 : 0;
        EXPECT_EQ(answerOf(decision, Answer::sample, key), answerOf(decision, Answer::sample, key));
        EXPECT_FALSE(answerOf(decision, Answer::mostLikely, key));
    }
    EXPECT_NEAR(yes, 0.3 * draws, 4 * std::sqrt(0.21 * draws));
    // Within an episode the answer turns once at most while the probability rises.
    for (std::uint64_t episode = 0; episode < 100; ++episode) {
        bool last = false;
        for (int percent = 50; percent <= 100; ++percent) {
            decision.collides = true;
            decision.probability = static_cast<float>(percent) / 100;
            const bool now = answerOf(decision, Answer::sample, {2, 7, episode});
            EXPECT_FALSE(last && !now);
            last = now;
        }
        EXPECT_TRUE(last);
    }
    decision.certain = true;
    decision.collides = false;
    EXPECT_FALSE(answerOf(decision, Answer::sample, {}));
}

}  // namespace
}  // namespace grapeshot::test
