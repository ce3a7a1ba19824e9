#include <grapeshot/narrowphase/penetration.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scenes/shapes.hpp"
#include "scenes/true_penetration.hpp"
#include "support/poses.hpp"
#include "support/test_size.hpp"

namespace grapeshot {
namespace {

using Eigen::Vector3f;
using test::Random;

/// A mesh, its model and its judge.
struct JudgedBody {
    explicit JudgedBody(const scenes::Mesh& mesh) : model(makeModel(mesh.view())), truth(mesh.view()) {}
    MeshModel model;
    scenes::TrueSurface truth;
};

double trueDepth(const JudgedBody& a, const JudgedBody& b, const Pose& bInA) {
    const scenes::PoseD pose{bInA.rotation.cast<double>(), bInA.translation.cast<double>()};
    return scenes::truePenetration(a.truth, {}, b.truth, pose);
}

bool collides(const JudgedBody& a, const JudgedBody& b, const Pose& bInA) {
    return Query(a.model.tree, b.model.tree).decide(bInA, DecideSettings::exact()).collides;
}

std::vector<SurfaceContact> cutContacts(const JudgedBody& a, const JudgedBody& b, const Pose& bInA,
                                        const PenetrationSettings& settings = {},
                                        const std::vector<SurfaceContact>& already = {}) {
    const Contacts pairs = Query(a.model.tree, b.model.tree).contacts(bInA, {0.01F, Order::depthFirst});
    std::vector<SurfaceContact> out;
    penetrationContacts(a.model, b.model, bInA, pairs.pairs, already, settings, out);
    return out;
}

void expectWellFormed(const std::vector<SurfaceContact>& contacts) {
    for (const SurfaceContact& contact : contacts) {
        EXPECT_TRUE(contact.onA.allFinite() && contact.onB.allFinite() && contact.normal.allFinite());
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-4);
        EXPECT_LE(contact.signedDistance, 0);
        EXPECT_LT((contact.onB + contact.normal * contact.signedDistance - contact.onA).norm(), 1e-4);
        EXPECT_NE(contact.triangleA, noTriangle);
        EXPECT_NE(contact.triangleB, noTriangle);
    }
}

const SurfaceContact& deepest(const std::vector<SurfaceContact>& contacts) {
    return *std::min_element(contacts.begin(), contacts.end(),
                             [](const auto& l, const auto& r) { return l.signedDistance < r.signedDistance; });
}

TEST(Penetration, OfTwoBallsIsAlongTheLineOfTheirMiddles) {
    const JudgedBody ball(scenes::sphere(0.5F, 8));
    Random random(1);
    for (const float apart : {0.95F, 0.8F, 0.6F, 0.4F}) {
        for (int trial = 0; trial < 5; ++trial) {
            const Vector3f direction = random.direction();
            Pose pose{random.rotation(), apart * direction};
            const auto contacts = cutContacts(ball, ball, pose);
            ASSERT_FALSE(contacts.empty());
            EXPECT_LE(contacts.size(), 4U);
            expectWellFormed(contacts);
            const SurfaceContact& contact = deepest(contacts);
            EXPECT_GT(contact.normal.dot(-direction), 0.99F) << "on B pointing to A";
            EXPECT_NEAR(-contact.signedDistance, 1 - apart, 0.02);
            // Moving A along the normal is moving B against it.
            pose.translation -= contact.normal * (-contact.signedDistance + 0.02F);
            EXPECT_FALSE(collides(ball, ball, pose));
        }
    }
}

TEST(Penetration, OfBlocksIsTheOverlapWhateverTheTessellation) {
    for (const int cells : {1, 6}) {
        const JudgedBody lower(scenes::box({1, 0.5F, 1}, cells));
        const JudgedBody upper(scenes::box({0.3F, 0.5F, 0.3F}, cells));
        for (const float depth : {0.03F, 0.1F, 0.3F}) {
            Pose pose{Eigen::AngleAxisf(0.4F, Vector3f::UnitY()).toRotationMatrix(), {0.1F, 1 - depth, 0.05F}};
            // The upper one's sides are cut in one rectangle, however far apart the middles of its pieces are.
            const auto contacts = cutContacts(lower, upper, pose);
            EXPECT_LE(contacts.size(), 4U);
            expectWellFormed(contacts);
            ASSERT_GE(contacts.size(), 3U);
            for (const SurfaceContact& contact : contacts) {
                EXPECT_NEAR(contact.signedDistance, -depth, 1e-4);
                EXPECT_LT((contact.normal + Vector3f::UnitY()).norm(), 1e-3);
            }
        }
    }
}

TEST(Penetration, OfCrossingBarsNeedsNoVertexInside) {
    const JudgedBody bar(scenes::box({1, 0.1F, 0.1F}, 1));
    for (const float overlap : {0.02F, 0.1F}) {
        const Pose pose{Eigen::AngleAxisf(1.5F, Vector3f::UnitY()).toRotationMatrix(), {0.03F, 0.2F - overlap, 0.01F}};
        const auto contacts = cutContacts(bar, bar, pose);
        ASSERT_FALSE(contacts.empty());
        expectWellFormed(contacts);
        EXPECT_NEAR(deepest(contacts).signedDistance, -overlap, 0.1F * overlap);
        EXPECT_LT(deepest(contacts).normal.y(), -0.99F);
    }
}

TEST(Penetration, IsExplainedByANearContactThatPushesTheSameWay) {
    const JudgedBody ball(scenes::sphere(0.5F, 6));
    const Pose pose{Eigen::Matrix3f::Identity(), {0, 0.9F, 0}};
    const auto contacts = cutContacts(ball, ball, pose);
    ASSERT_FALSE(contacts.empty());
    SurfaceContact known = deepest(contacts);
    const PenetrationSettings wide{0.5F, 0.5F, 4};
    EXPECT_TRUE(cutContacts(ball, ball, pose, wide, {known}).empty());
    known.signedDistance = 0.01F;
    EXPECT_FALSE(cutContacts(ball, ball, pose, wide, {known}).empty()) << "separated contacts explain nothing";
    known.signedDistance = -0.1F;
    known.normal = -known.normal;
    EXPECT_FALSE(cutContacts(ball, ball, pose, wide, {known}).empty()) << "nor do those that pull inwards";
    known.normal = -known.normal;
    known.onA.x() += 5;
    known.onB.x() += 5;
    EXPECT_FALSE(cutContacts(ball, ball, pose, wide, {known}).empty()) << "nor those elsewhere";
}

TEST(Penetration, DistantCutsAreSeparate) {
    // A ring flat in a plate's upper side: two cuts by its two halves if the plate is a narrow bar.
    const JudgedBody ring(scenes::torus(0.5F, 0.1F, 60, 24));
    const JudgedBody bar(scenes::box({2, 0.5F, 0.05F}, 20));
    const Pose pose{Eigen::Matrix3f::Identity(), {0, -0.53F, 0}};
    const auto contacts = cutContacts(ring, bar, pose);
    expectWellFormed(contacts);
    for (const float side : {-1.0F, 1.0F}) {
        std::vector<SurfaceContact> here;
        std::copy_if(contacts.begin(), contacts.end(), std::back_inserter(here),
                     [&](const SurfaceContact& contact) { return side * contact.onA.x() > 0.3F; });
        ASSERT_FALSE(here.empty());
        EXPECT_NEAR(deepest(here).signedDistance, -0.07, 1e-3);
        EXPECT_GT(deepest(here).normal.y(), 0.99F);
    }
}

TEST(Penetration, OfABallInAnOpenSheetFollowsTheWinding) {
    const JudgedBody sheet(scenes::grid(2, 2, 30, 30));
    const JudgedBody ball(scenes::sphere(0.5F, 6));
    ASSERT_FALSE(sheet.model.solid);
    for (const float height : {0.3F, 0.05F, -0.2F}) {
        const Pose pose{Eigen::Matrix3f::Identity(), {0.1F, height, 0.1F}};
        const auto contacts = cutContacts(sheet, ball, pose);
        ASSERT_FALSE(contacts.empty());
        expectWellFormed(contacts);
        EXPECT_LT(deepest(contacts).normal.y(), -0.99F) << "the ball goes up";
        EXPECT_NEAR(-deepest(contacts).signedDistance, 0.5F - height, 0.03);
    }
}

struct PushCase {
    const char* name;
    scenes::Mesh a, b;
};

std::vector<PushCase> pushCases() {
    std::vector<PushCase> cases;
    cases.push_back({"balls", scenes::sphere(0.5F, 6), scenes::sphere(0.3F, 4)});
    cases.push_back({"boxes", scenes::box({0.4F, 0.3F, 0.5F}, 4), scenes::box({0.3F, 0.3F, 0.3F}, 1)});
    cases.push_back({"tori", scenes::torus(0.5F, 0.15F, 40, 16), scenes::torus(0.5F, 0.15F, 40, 16)});
    cases.push_back({"ball in cup", scenes::cup(0.5F, 0.12F, 0.7F, 40, 12), scenes::sphere(0.3F, 4)});
    cases.push_back({"spiked balls", scenes::spikedBall(0.4F, 0.2F, 8, 1500), scenes::spikedBall(0.4F, 0.2F, 8, 1500)});
    return cases;
}

/// One push along the deepest contact of each cut in turn, until the surfaces part: few pushes, and the first one
/// already helps.
TEST(Penetration, PushesApart) {
    const std::size_t trials = test::sampleSize(25, 250);
    for (const PushCase& shapes : pushCases()) {
        SCOPED_TRACE(shapes.name);
        const JudgedBody a(shapes.a), b(shapes.b);
        Random random(7);
        std::size_t tried = 0, parted = 0, better = 0, deep = 0;
        while (tried < trials) {
            Pose pose = test::randomPose(a.model.tree, b.model.tree, random);
            if (!collides(a, b, pose)) {
                continue;
            }
            ++tried;
            const double before = trueDepth(a, b, pose);
            deep += before > 0.05 ? 1U : 0U;
            for (int push = 0; push < 8 && collides(a, b, pose); ++push) {
                const auto contacts = cutContacts(a, b, pose);
                expectWellFormed(contacts);
                ASSERT_FALSE(contacts.empty());
                const SurfaceContact& contact = deepest(contacts);
                pose.translation -= contact.normal * (-contact.signedDistance + 0.002F);
                if (push == 0 && (trueDepth(a, b, pose) < 0.9 * before || !collides(a, b, pose))) {
                    ++better;
                }
            }
            parted += collides(a, b, pose) ? 0U : 1U;
        }
        EXPECT_GT(deep, trials / 2);
        EXPECT_GE(parted, trials * 8 / 10);
        EXPECT_GE(better, trials * 7 / 10);
    }
}

TEST(Penetration, SwappedBodiesSeeTheSameFromTheOtherSide) {
    const std::size_t trials = test::sampleSize(15, 150);
    for (const PushCase& shapes : pushCases()) {
        SCOPED_TRACE(shapes.name);
        const JudgedBody a(shapes.a), b(shapes.b);
        Random random(8);
        std::size_t differing = 0;
        for (std::size_t tried = 0; tried < trials;) {
            const Pose pose = test::randomPose(a.model.tree, b.model.tree, random);
            if (!collides(a, b, pose)) {
                continue;
            }
            ++tried;
            const auto there = cutContacts(a, b, pose);
            const auto back = cutContacts(b, a, inverse(pose));
            ASSERT_FALSE(there.empty());
            ASSERT_FALSE(back.empty());
            const SurfaceContact& one = deepest(there);
            // Several cuts may be about equally deep, and other vertices may have been measured where many are equal.
            const float tolerance = 0.15F * -one.signedDistance + 1e-3F;
            const bool mirrored = std::any_of(back.begin(), back.end(), [&](const SurfaceContact& other) {
                return (pose.rotation * other.normal + one.normal).norm() < 0.01F &&
                       std::abs(other.signedDistance - one.signedDistance) < tolerance;
            });
            const bool asDeep = std::abs(deepest(back).signedDistance - one.signedDistance) <= tolerance;
            differing += mirrored && asDeep ? 0U : 1U;
        }
        // At most 256 vertices of each body are measured: deep among many, not always the same ones.
        EXPECT_LE(differing, trials / 50);
    }
}

TEST(Containment, OfASmallBodyInABigOneInBothOrders) {
    const JudgedBody big(scenes::sphere(1, 8));
    const JudgedBody small(scenes::box({0.1F, 0.1F, 0.1F}, 2));
    Random random(9);
    for (int trial = 0; trial < 20; ++trial) {
        const Pose pose{random.rotation(), static_cast<float>(random.uniform(0, 0.7)) * random.direction()};
        std::vector<SurfaceContact> there, back;
        containmentContacts(big.model, small.model, pose, there);
        containmentContacts(small.model, big.model, inverse(pose), back);
        ASSERT_EQ(there.size(), 1U);
        ASSERT_EQ(back.size(), 1U);
        expectWellFormed(there);
        expectWellFormed(back);
        EXPECT_NEAR(there[0].signedDistance, back[0].signedDistance, 1e-4);
        EXPECT_LT((there[0].normal + pose.rotation * back[0].normal).norm(), 0.01F);
        // The vertex comes out on the nearest side.
        const Vector3f out = there[0].onB - there[0].normal * (-there[0].signedDistance);
        EXPECT_NEAR(out.norm(), 1, 0.03);
        EXPECT_LT(-there[0].signedDistance, 1 - pose.translation.norm() + 0.2F);
    }
}

TEST(Containment, IsAskedOfEachPiece) {
    const JudgedBody block(scenes::box({0.3F, 0.3F, 0.3F}, 2));
    const auto satellite = scenes::merged(scenes::sphere(0.05F, 2), scenes::sphere(0.05F, 2), {0.25F, 0, 0});
    const JudgedBody two(satellite);
    ASSERT_EQ(two.model.report.pieces, 2U);
    std::vector<SurfaceContact> out;
    for (const float x : {0.15F, -0.4F, 0.0F}) {
        // Second piece out, first piece out, both in.
        out.clear();
        containmentContacts(block.model, two.model, {Eigen::Matrix3f::Identity(), {x, 0, 0}}, out);
        EXPECT_EQ(out.empty(), false) << x;
        expectWellFormed(out);
    }
}

TEST(Containment, NotOfBodiesInHollowsOrBesideNorInSheets) {
    const JudgedBody cup(scenes::cup(0.5F, 0.05F, 0.8F, 40, 10));
    const JudgedBody ball(scenes::sphere(0.2F, 4));
    const JudgedBody sheet(scenes::grid(2, 2, 4, 4));
    const Vector3f middle = 0.5F * (cup.model.tree.lower + cup.model.tree.upper);
    std::vector<SurfaceContact> out;
    containmentContacts(cup.model, ball.model, {Eigen::Matrix3f::Identity(), middle}, out);
    containmentContacts(ball.model, ball.model, {Eigen::Matrix3f::Identity(), {0.5F, 0, 0}}, out);
    containmentContacts(sheet.model, ball.model, {Eigen::Matrix3f::Identity(), {0, 0, 0}}, out);
    containmentContacts(ball.model, sheet.model, {Eigen::Matrix3f::Identity(), {0, 0, 0}}, out);
    EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace grapeshot
