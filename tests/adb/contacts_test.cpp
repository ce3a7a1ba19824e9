// `contacts`, `leafPairs` and `contactsOf` against the slow truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <grapeshot/adb/query.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

PairSet pairsOf(const Contacts& contacts) {
    PairSet set;
    for (const TriangleContact& contact : contacts.pairs) {
        EXPECT_TRUE(set.emplace(contact.pair.triangleA, contact.pair.triangleB).second) << "listed twice";
    }
    return set;
}

/// Same pairs as brute force, but for those at the distance within the borderline; and each contact's numbers hold.
void expectTruth(const Tree& a, const Tree& b, const Pose& pose, float distance, const Contacts& contacts) {
    const double borderline = 1e-6 * (double{a.radius} + b.radius + pose.translation.cast<double>().norm() + distance);
    const PairSet found = pairsOf(contacts);
    PairSet truth;
    for (const TrianglePair& pair : bruteForcePairs(a.mesh(), b.mesh(), pose, distance)) {
        truth.emplace(pair.triangleA, pair.triangleB);
    }
    PairSet different;
    std::set_symmetric_difference(found.begin(), found.end(), truth.begin(), truth.end(),
                                  std::inserter(different, different.end()));
    for (const auto& [first, second] : different) {
        EXPECT_NEAR(triangleDistance(cornersOf(a.mesh(), first), cornersOf(b.mesh(), second, pose)), distance,
                    borderline);
    }
    for (const TriangleContact& contact : contacts.pairs) {
        const Corners onA = cornersOf(a.mesh(), contact.pair.triangleA);
        const Corners onB = cornersOf(b.mesh(), contact.pair.triangleB, pose);
        EXPECT_LE(contact.signedDistance, distance);
        if (contact.overlapping) {
            EXPECT_LE(contact.signedDistance, 0);
            EXPECT_LE(triangleDistance(onA, onB), borderline);
        } else {
            EXPECT_NEAR(contact.signedDistance, triangleDistance(onA, onB), borderline);
            EXPECT_NEAR((contact.onA - contact.onB).norm(), contact.signedDistance, borderline);
        }
        const Eigen::Vector3d pointA = contact.onA.cast<double>();
        const Eigen::Vector3d pointB = contact.onB.cast<double>();
        EXPECT_LE(triangleDistance(onA, {pointA, pointA, pointA}), 10 * borderline);
        EXPECT_LE(triangleDistance(onB, {pointB, pointB, pointB}), 10 * borderline);
        EXPECT_LE(contact.featureA, 6);
        EXPECT_LE(contact.featureB, 6);
    }
}

TEST(Contacts, AreAllPairsWithinTheDistance) {
    Random random(1);
    std::size_t listed = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        Query query(tree, tree);
        Contacts contacts;
        for (std::size_t i = 0; i < sampleSize(3, 100); ++i) {
            const Pose pose = randomPose(tree, tree, random);
            for (const float distance : {0.0F, 0.01F, 0.1F}) {
                for (const Order order : {Order::depthFirst, Order::bestFirst}) {
                    query.contacts(pose, {distance, order}, {}, contacts);
                    ASSERT_TRUE(contacts.certain);
                    EXPECT_EQ(contacts.stop, StopReason::certain);
                    expectTruth(tree, tree, pose, distance, contacts);
                    listed += contacts.pairs.size();
                }
            }
        }
    }
    EXPECT_GT(listed, 1000U);
}

TEST(Contacts, AtAllScalesAndFarFromTheOrigin) {
    Random random(2);
    const scenes::Mesh sound = scenes::bumpySphere(1, 0.25F, 6, 3);
    for (const float scale : {1e-6F, 1.0F, 1e6F}) {
        SCOPED_TRACE(scale);
        const Tree tree = build(scenes::scaled(sound, scale).view());
        Query query(tree, tree);
        for (std::size_t i = 0; i < sampleSize(5, 100); ++i) {
            const Pose pose = randomPose(tree, tree, random);
            const float distance = 0.05F * scale;
            expectTruth(tree, tree, pose, distance, query.contacts(pose, {distance}));
        }
    }
    const Tree far = build(scenes::moved(scenes::scaled(sound, 100), {1e6F, 1e6F, -1e6F}).view());
    Query query(far, far);
    for (std::size_t i = 0; i < sampleSize(5, 100); ++i) {
        const Pose pose = randomPose(far, far, random);
        expectTruth(far, far, pose, 10, query.contacts(pose, {10}));
    }
}

TEST(Contacts, NothingBeyondReachAndEverythingWithoutLimit) {
    const Tree tree = build(scenes::sphere(1, 2).view());
    Query query(tree, tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {10, 0, 0}};
    EXPECT_TRUE(query.contacts(pose, {7.9F}).pairs.empty());
    const Contacts all = query.contacts(pose, {std::numeric_limits<float>::infinity()});
    EXPECT_TRUE(all.certain);
    EXPECT_EQ(pairsOf(all).size(), tree.triangles.size() * tree.triangles.size());
}

TEST(Contacts, ListingKeepsTheMemoryOfTheCaller) {
    const Tree tree = build(scenes::torus(1, 0.3F, 20, 8).view());
    Query query(tree, tree);
    Contacts contacts;
    query.contacts(Pose{Eigen::Matrix3f::Identity(), {0.5F, 0.1F, 0}}, {0.1F}, {}, contacts);
    ASSERT_FALSE(contacts.pairs.empty());
    const std::size_t capacity = contacts.pairs.capacity();
    query.contacts(Pose{Eigen::Matrix3f::Identity(), {5, 0, 0}}, {0.1F}, {}, contacts);
    EXPECT_TRUE(contacts.pairs.empty());
    EXPECT_EQ(contacts.pairs.capacity(), capacity);
}

TEST(LeafPairs, HoldEveryContactAndLeadToThem) {
    Random random(3);
    std::size_t listed = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        Query query(tree, tree);
        for (std::size_t i = 0; i < sampleSize(5, 50); ++i) {
            const Pose pose = randomPose(tree, tree, random);
            const float distance = 0.03F;
            LeafPairs leaves;
            query.leafPairs(pose, {distance}, {}, leaves);
            ASSERT_TRUE(leaves.certain);
            EXPECT_EQ(std::set<LeafPair>(leaves.pairs.begin(), leaves.pairs.end()).size(), leaves.pairs.size());
            Contacts viaLeaves;
            query.contactsOf(leaves.pairs, pose, distance, {}, viaLeaves);
            EXPECT_TRUE(viaLeaves.certain);
            EXPECT_EQ(viaLeaves.work, leaves.pairs.size());
            const Contacts direct = query.contacts(pose, {distance});
            EXPECT_EQ(direct.work, leaves.work + viaLeaves.work);
            ASSERT_EQ(viaLeaves.pairs.size(), direct.pairs.size());
            for (std::size_t k = 0; k < direct.pairs.size(); ++k) {
                EXPECT_EQ(viaLeaves.pairs[k].pair, direct.pairs[k].pair);
                EXPECT_EQ(viaLeaves.pairs[k].signedDistance, direct.pairs[k].signedDistance);
            }
            listed += direct.pairs.size();
        }
    }
    EXPECT_GT(listed, 1000U);
}

TEST(ContactsOf, AreDoneFromTheFront) {
    const Tree tree = build(scenes::torus(1, 0.3F, 20, 8).view());
    Query query(tree, tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {0.5F, 0.1F, 0}};
    LeafPairs leaves;
    query.leafPairs(pose, {0.05F}, {}, leaves);
    ASSERT_GT(leaves.pairs.size(), 10U);
    Contacts all;
    Contacts some;
    query.contactsOf(leaves.pairs, pose, 0.05F, {}, all);
    query.contactsOf(leaves.pairs, pose, 0.05F, {7}, some);
    EXPECT_FALSE(some.certain);
    EXPECT_EQ(some.stop, StopReason::budget);
    EXPECT_EQ(some.work, 7U);
    Contacts front;
    query.contactsOf(std::span(leaves.pairs).first(7), pose, 0.05F, {}, front);
    EXPECT_TRUE(front.certain);
    ASSERT_EQ(some.pairs.size(), front.pairs.size());
    EXPECT_LT(some.pairs.size(), all.pairs.size());
    query.contactsOf({}, pose, 0.05F, {}, some);
    EXPECT_TRUE(some.certain);
    EXPECT_TRUE(some.pairs.empty());
}

TEST(ContactsOf, RefusesLeavesThatDoNotExist) {
    const Tree tree = build(scenes::sphere(1, 3).view());
    Query query(tree, tree);
    const std::vector<LeafPair> pairs = {{0, 0}, {0, static_cast<std::uint32_t>(tree.leaves.size())}};
    Contacts contacts;
    query.contactsOf(pairs, Pose{}, 0.1F, {}, contacts);
    EXPECT_EQ(contacts.stop, StopReason::invalidInput);
    EXPECT_TRUE(contacts.pairs.empty());
}

TEST(Contacts, RefuseBadDistancesAndPoses) {
    const Tree tree = build(scenes::sphere(1, 3).view());
    Query query(tree, tree);
    Contacts contacts;
    LeafPairs leaves;
    Pose bad;
    bad.rotation(2, 2) = std::numeric_limits<float>::quiet_NaN();
    const auto expectRefused = [&](const Pose& pose, float distance) {
        query.contacts(pose, {distance}, {}, contacts);
        EXPECT_EQ(contacts.stop, StopReason::invalidInput);
        EXPECT_FALSE(contacts.certain);
        EXPECT_TRUE(contacts.pairs.empty());
        query.resumeContacts({}, contacts);
        EXPECT_EQ(contacts.stop, StopReason::invalidInput);
        query.leafPairs(pose, {distance}, {}, leaves);
        EXPECT_EQ(leaves.stop, StopReason::invalidInput);
        query.resumeLeafPairs({}, leaves);
        EXPECT_EQ(leaves.stop, StopReason::invalidInput);
        const LeafPair first;
        query.contactsOf(std::span(&first, 1), pose, distance, {}, contacts);
        EXPECT_EQ(contacts.stop, StopReason::invalidInput);
    };
    expectRefused(bad, 0.1F);
    expectRefused(Pose{}, -0.1F);
    expectRefused(Pose{}, std::numeric_limits<float>::quiet_NaN());
}

}  // namespace
}  // namespace grapeshot::test
