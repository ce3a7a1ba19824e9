// What a certificate promises, refuses and says of itself.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include <grapeshot/adb/certificate.hpp>
#include <grapeshot/adb/certification_poses.hpp>
#include <grapeshot/adb/detail/fixed_sequence.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/rate_bound.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

const Tree& ball() {
    static const Tree tree = build(scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 10)).view());
    return tree;
}

TEST(FixedSequence, StopsAtTheFirstThatFails) {
    const std::vector<std::uint64_t> errors = {0, 2, 5, 3, 9};
    EXPECT_EQ(detail::walkPath(errors, 4).passed, 2U);  // not the fourth, though it would pass
    EXPECT_EQ(detail::walkPath(errors, 4).errors, 2U);
    EXPECT_EQ(detail::walkPath(errors, 9).passed, 5U);
    EXPECT_EQ(detail::walkPath(errors, 9).errors, 9U);
    EXPECT_EQ(detail::walkPath(errors, -1).passed, 0U);
    EXPECT_EQ(detail::walkPath({}, 4).passed, 0U);
}

TEST(FixedSequence, AllowsWhatTheBoundAllows) {
    EXPECT_EQ(detail::mostErrorsAllowed(0, 0.5, 0.95), -1);
    EXPECT_EQ(detail::mostErrorsAllowed(298, 0.01, 0.95), -1);
    EXPECT_EQ(detail::mostErrorsAllowed(299, 0.01, 0.95), 0);
    for (const std::uint64_t trials : {400U, 1500U, 4000U}) {
        const auto most = static_cast<std::uint64_t>(detail::mostErrorsAllowed(trials, 0.01, 0.975));
        EXPECT_LE(upperRate(most, trials, 0.975), 0.01);
        EXPECT_GT(upperRate(most + 1, trials, 0.975), 0.01);
    }
}

TEST(FixedSequence, CertifiesTooMuchSeldom) {
    // Rates that rise along the path; the third and later ones are above the limit. How often does it get there?
    const std::vector<double> rates = {0.002, 0.008, 0.0101, 0.02, 0.05};
    constexpr std::uint64_t trials = 1200;
    constexpr double confidence = 0.9;
    const std::int64_t most = detail::mostErrorsAllowed(trials, 0.01, confidence);
    Random random(1);
    const std::size_t runs = sampleSize(400, 10'000);
    std::uint64_t tooFar = 0;
    for (std::size_t run = 0; run < runs; ++run) {
        std::vector<std::uint64_t> errors(rates.size());
        for (std::size_t level = 0; level < rates.size(); ++level) {
            for (std::uint64_t i = 0; i < trials; ++i) {
                errors[level] += random.unit() < rates[level] ? 1U : 0U;
            }
        }
        tooFar += detail::walkPath(errors, most).passed > 2 ? 1U : 0U;
    }
    EXPECT_LE(lowerRate(tooFar, runs, 0.999), 1 - confidence);
}

TEST(CertificationPoses, AreZachmanns) {
    const std::vector<Pose> poses = certificationPoses(ball(), ball(), 3000, 5);
    ASSERT_EQ(poses.size(), 3000U);
    Query query(ball(), ball());
    std::uint64_t colliding = 0;
    for (const Pose& pose : poses) {
        ASSERT_TRUE(isRigid(pose));
        colliding += query.decide(pose, DecideSettings::exact()).collides ? 1U : 0U;
    }
    // The same share as by the tests' own generator.
    std::uint64_t others = 0;
    for (const Pose& pose : zachmannPoses(ball(), ball(), 12, 250, 6).poses) {
        others += query.decide(pose, DecideSettings::exact()).collides ? 1U : 0U;
    }
    EXPECT_LE(lowerRate(colliding, 3000, 0.999), upperRate(others, 3000, 0.999));
    EXPECT_GE(upperRate(colliding, 3000, 0.999), lowerRate(others, 3000, 0.999));
    // A longer list begins with the shorter one; another seed is another list.
    EXPECT_EQ(certificationPoses(ball(), ball(), 10, 5)[9].translation, poses[9].translation);
    EXPECT_NE(certificationPoses(ball(), ball(), 10, 6)[9].translation, poses[9].translation);
}

TEST(Certificate, KeepsItsPromiseOnFreshPoses) {
    // Each of the certificates may break it with probability 0.05; four of these, one too many would be a rare thing.
    int broken = 0;
    for (const char* name : {"torus knot", "bumpy sphere", "gear", "chain shot"}) {
        for (const NamedMesh& kind : everyKind()) {
            if (kind.name != name) {
                continue;
            }
            SCOPED_TRACE(name);
            const Tree tree = build(kind.mesh.view());
            const Certificate certificate =
                calibrate(tree, tree, {.missLimit = 0.02, .falseAlarmLimit = 0.05, .poses = sampleSize(2000, 8000)});
            ASSERT_TRUE(certificate.certified) << certificate.reason;
            EXPECT_LE(certificate.missBound, 0.02);
            EXPECT_LE(certificate.falseAlarmBound, 0.05);
            EXPECT_LT(certificate.workPerPose, certificate.exactWorkPerPose);
            EXPECT_GT(certificate.settings.rejectAt + (1 - certificate.settings.acceptAt), 0);
            EXPECT_EQ(certificate.poses, "zachmann");
            std::uint64_t colliding = 0;
            std::uint64_t clear = 0;
            std::uint64_t misses = 0;
            std::uint64_t alarms = 0;
            Query query(tree, tree);
            for (const Pose& pose : zachmannPoses(tree, tree, 12, static_cast<int>(sampleSize(200, 2000)), 77).poses) {
                const bool truth = query.decide(pose, DecideSettings::exact()).collides;
                const bool answer = query.decide(pose, certificate.settings).collides;
                ++(truth ? colliding : clear);
                misses += truth && !answer ? 1U : 0U;
                alarms += !truth && answer ? 1U : 0U;
            }
            EXPECT_GT(colliding, 300U);
            EXPECT_GT(clear, 300U);
            broken += lowerRate(misses, colliding, 0.99) > 0.02 || lowerRate(alarms, clear, 0.99) > 0.05 ? 1 : 0;
        }
    }
    EXPECT_LE(broken, 1);
}

TEST(Certificate, BothLimitsTogetherErrNoMoreThanEachAlone) {
    // What lets the two paths be tested apart: pose by pose, and for fewer steps and tighter limits as well.
    Query query(ball(), ball());
    std::vector<Pose> poses = certificationPoses(ball(), ball(), sampleSize(500, 5000), 9);
    for (const double gap : {-0.003, 0.003}) {
        const std::vector<Pose> near = grazingPoses(ball(), ball(), static_cast<int>(sampleSize(100, 1000)), gap, 4);
        poses.insert(poses.end(), near.begin(), near.end());
    }
    int wrong = 0;
    for (const Pose& pose : poses) {
        const bool truth = query.decide(pose, DecideSettings::exact()).collides;
        DecideSettings alone{
            .estimateSteps = 16, .acceptAt = truth ? 1 : 0.7F, .rejectAt = truth ? 0.3F : 0, .tryWitness = false};
        if (query.decide(pose, alone).collides != truth) {
            ++wrong;
            continue;
        }
        for (const std::uint64_t steps : {16U, 5U}) {
            for (const float tighter : {1.0F, 0.2F}) {
                DecideSettings both{.estimateSteps = steps, .acceptAt = 1 - 0.3F * tighter, .rejectAt = 0.3F * tighter};
                EXPECT_EQ(query.decide(pose, both).collides, truth);
            }
        }
    }
    EXPECT_GT(wrong, 0);
}

TEST(Certificate, IsTheSameForTheSameSeedOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    const CertificationSettings settings{.poses = 1500, .seed = 11};
    const Certificate first = calibrate(ball(), ball(), settings);
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        const Certificate again = calibrate(ball(), ball(), settings);
        EXPECT_EQ(again.certified, first.certified);
        EXPECT_EQ(again.settings.acceptAt, first.settings.acceptAt);
        EXPECT_EQ(again.settings.rejectAt, first.settings.rejectAt);
        EXPECT_EQ(again.misses, first.misses);
        EXPECT_EQ(again.falseAlarms, first.falseAlarms);
        EXPECT_EQ(again.missBound, first.missBound);
        EXPECT_EQ(again.colliding, first.colliding);
        EXPECT_EQ(again.work, first.work);
    }
    const Certificate other = calibrate(ball(), ball(), {.poses = 1500, .seed = 12});
    EXPECT_NE(other.work, first.work);
    EXPECT_EQ(other.seed, 12U);
}

void expectRefused(const Certificate& certificate, Refusal why) {
    EXPECT_FALSE(certificate.certified);
    EXPECT_EQ(certificate.refusal, why);
    EXPECT_FALSE(certificate.reason.empty());
    EXPECT_EQ(certificate.settings.estimateSteps, 0U);
    EXPECT_EQ(certificate.settings.acceptAt, 1);
    EXPECT_EQ(certificate.settings.rejectAt, 0);
}

TEST(Certificate, RefusesWhatTheSampleCannotShow) {
    expectRefused(calibrate(ball(), ball(), {.poses = 300}), Refusal::fewColliding);
    expectRefused(calibrate(ball(), ball(), {.missLimit = 1e-4}), Refusal::fewColliding);
    expectRefused(calibrate(ball(), ball(), {.missLimit = 0.2, .falseAlarmLimit = 1e-4}), Refusal::fewClear);
    EXPECT_NE(calibrate(ball(), ball(), {.poses = 300}).reason.find("of 300 poses"), std::string::npos);
    // All far apart: nothing collides.
    const std::vector<Pose> far(1000, Pose{Eigen::Matrix3f::Identity(), {50, 0, 0}});
    const Certificate certificate = calibrate(ball(), ball(), {.givenPoses = far, .givenName = "far"});
    expectRefused(certificate, Refusal::fewColliding);
    EXPECT_EQ(certificate.poses, "far");
    EXPECT_EQ(certificate.clear, 1000U);
    expectRefused(calibrate(Tree(), ball(), {.poses = 10}), Refusal::fewColliding);
}

TEST(Certificate, HoldsForTheGivenPoses) {
    // Hard ones: half just touch, half just do not. It must not promise on them what it promises on Zachmann's.
    std::vector<Pose> close;
    for (const double gap : {-0.001, 0.001}) {
        const std::vector<Pose> some = grazingPoses(ball(), ball(), 600, gap, 21);
        close.insert(close.end(), some.begin(), some.end());
    }
    const Certificate hard = calibrate(ball(), ball(), {.givenPoses = close, .givenName = "grazing"});
    const Certificate easy = calibrate(ball(), ball(), {});
    ASSERT_TRUE(easy.certified);
    EXPECT_LE(hard.settings.rejectAt, easy.settings.rejectAt);
    EXPECT_GT(1 - easy.settings.acceptAt, hard.certified ? 1 - hard.settings.acceptAt : 0);
    EXPECT_EQ(hard.colliding + hard.clear, close.size());
}

TEST(Certificate, RefusesBadSettings) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto expectBad = [](const CertificationSettings& settings, const char* place) {
        try {
            static_cast<void>(calibrate(ball(), ball(), settings));
            ADD_FAILURE() << place;
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), Fault::badSetting);
            EXPECT_EQ(error.place(), place);
        }
    };
    for (const double bad : {0.0, 1.0, -0.1, nan}) {
        expectBad({.missLimit = bad}, "CertificationSettings::missLimit");
        expectBad({.falseAlarmLimit = bad}, "CertificationSettings::falseAlarmLimit");
    }
    for (const double bad : {0.49, 1.0, nan}) {
        expectBad({.confidence = bad}, "CertificationSettings::confidence");
    }
    expectBad({.poses = 0}, "CertificationSettings::poses");
    expectBad({.poses = 10'000'001}, "CertificationSettings::poses");
    expectBad({.estimateSteps = 0}, "CertificationSettings::estimateSteps");
    std::vector<Pose> poses(3);
    poses[2].rotation *= 2;
    try {
        static_cast<void>(calibrate(ball(), ball(), {.givenPoses = poses}));
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::notRigid);
        EXPECT_EQ(error.place(), "pose 2");
    }
}

}  // namespace
}  // namespace grapeshot::test
