// Laws of the two questions to a pair of trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/instruction_set.hpp>
#include <support/test_size.hpp>

#include "law_samples.hpp"

namespace grapeshot::test {
namespace {

using Key = std::pair<std::uint32_t, std::uint32_t>;

std::map<Key, float> distancesOf(const Contacts& contacts, bool swapped) {
    std::map<Key, float> result;
    for (const TriangleContact& contact : contacts.pairs) {
        const auto [a, b] = contact.pair;
        EXPECT_TRUE(result.emplace(swapped ? Key{b, a} : Key{a, b}, contact.signedDistance).second)
            << "a pair of triangles is listed twice";
    }
    return result;
}

/// Same pairs with the same distances, but for pairs that the limit itself divides.
void expectSameContacts(const std::map<Key, float>& one, const std::map<Key, float>& other, float limit,
                        float tolerance) {
    for (const auto& [key, distance] : one) {
        const auto found = other.find(key);
        if (found == other.end()) {
            EXPECT_GT(distance, limit - tolerance) << "pair " << key.first << ", " << key.second << " is missing";
        } else if (distance > 0 && found->second > 0) {
            EXPECT_NEAR(distance, found->second, tolerance);
        }
    }
}

/// Is the answer at this pose decided by more than rounding? Asked of slightly displaced poses.
bool robust(const Tree& a, const Tree& b, const Pose& pose, float step) {
    Query query(a, b);
    const bool answer = query.decide(pose, DecideSettings::exact()).collides;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0F, 1.0F}) {
            Pose moved = pose;
            moved.translation[axis] += sign * step;
            if (query.decide(moved, DecideSettings::exact()).collides != answer) {
                return false;
            }
        }
    }
    return true;
}

class QueryLaws : public testing::TestWithParam<int> {
  protected:
    LawPair pair = lawPairs()[static_cast<std::size_t>(GetParam())];
    Tree a = build(pair.a.view());
    Tree b = build(pair.b.view());
    float size = std::max(sizeOf(a), sizeOf(b));
    std::vector<Pose> poses = lawPoses(a, b, sampleSize(300, 5000), 97);
};

TEST_P(QueryLaws, SwapGivesTheSameAnswer) {
    Query forth(a, b);
    Query back(b, a);
    int colliding = 0;
    int settled = 0;
    for (const Pose& pose : poses) {
        if (!robust(a, b, pose, 1e-5F * size)) {
            continue;
        }
        ++settled;
        const Decision one = forth.decide(pose, DecideSettings::exact());
        const Decision other = back.decide(inverse(pose), DecideSettings::exact());
        EXPECT_EQ(one.collides, other.collides);
        EXPECT_TRUE(one.certain && other.certain);
        colliding += one.collides ? 1 : 0;
    }
    EXPECT_GT(settled, static_cast<int>(poses.size()) * 9 / 10);
    EXPECT_GT(colliding, settled / 10);
    EXPECT_LT(colliding, settled * 9 / 10);
}

TEST_P(QueryLaws, SwapGivesTheSameContacts) {
    const ContactSettings near{.maxDistance = 0.02F * size};
    Query forth(a, b);
    Query back(b, a);
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < poses.size() / 5; ++i) {
        const auto one = distancesOf(forth.contacts(poses[i], near), false);
        const auto other = distancesOf(back.contacts(inverse(poses[i]), near), true);
        expectSameContacts(one, other, near.maxDistance, 1e-5F * size);
        expectSameContacts(other, one, near.maxDistance, 1e-5F * size);
        pairs += one.size();
    }
    EXPECT_GT(pairs, poses.size());
}

TEST_P(QueryLaws, RigidMotionOfBothChangesNothing) {
    Random random(31);
    const Pose motion{random.rotation(), size * random.direction()};
    const Tree movedA = build(movedBy(pair.a, motion).view());
    Query before(a, b);
    Query after(movedA, b);
    const ContactSettings near{.maxDistance = 0.02F * size};
    int settled = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Pose moved = compose(motion, poses[i]);
        if (robust(a, b, poses[i], 1e-5F * size)) {
            ++settled;
            EXPECT_EQ(before.decide(poses[i], DecideSettings::exact()).collides,
                      after.decide(moved, DecideSettings::exact()).collides);
        }
        if (i % 5 == 0) {
            const auto one = distancesOf(before.contacts(poses[i], near), false);
            const auto other = distancesOf(after.contacts(moved, near), false);
            expectSameContacts(one, other, near.maxDistance, 1e-5F * size);
            expectSameContacts(other, one, near.maxDistance, 1e-5F * size);
        }
    }
    EXPECT_GT(settled, static_cast<int>(poses.size()) * 9 / 10);
}

bool sameBytes(const Decision& x, const Decision& y) {
    return x.collides == y.collides && x.probability == y.probability && x.certain == y.certain && x.stop == y.stop &&
           x.work == y.work && x.witness == y.witness;
}

bool sameBytes(const TriangleContact& x, const TriangleContact& y) {
    return x.pair == y.pair && x.onA == y.onA && x.onB == y.onB && x.signedDistance == y.signedDistance &&
           x.featureA == y.featureA && x.featureB == y.featureB && x.overlapping == y.overlapping;
}

struct Answers {
    std::vector<Decision> decisions;
    std::vector<Contacts> contacts;
};

void expectSameBytes(const Answers& x, const Answers& y) {
    ASSERT_EQ(x.decisions.size(), y.decisions.size());
    for (std::size_t i = 0; i < x.decisions.size(); ++i) {
        EXPECT_TRUE(sameBytes(x.decisions[i], y.decisions[i])) << "decision " << i;
    }
    ASSERT_EQ(x.contacts.size(), y.contacts.size());
    for (std::size_t i = 0; i < x.contacts.size(); ++i) {
        EXPECT_EQ(x.contacts[i].work, y.contacts[i].work);
        EXPECT_TRUE(std::ranges::equal(x.contacts[i].pairs, y.contacts[i].pairs,
                                       [](const auto& p, const auto& q) { return sameBytes(p, q); }))
            << "contacts " << i;
    }
}

Answers ask(const Tree& a, const Tree& b, const std::vector<Pose>& poses, Order order) {
    Answers answers;
    Query query(a, b);
    const ContactSettings near{.maxDistance = 0.02F * sizeOf(a), .order = order};
    for (std::size_t i = 0; i < poses.size(); ++i) {
        answers.decisions.push_back(query.decide(poses[i], DecideSettings::exact(order)));
        if (i % 5 == 0) {
            answers.contacts.push_back(query.contacts(poses[i], near));
        }
    }
    return answers;
}

TEST_P(QueryLaws, EveryInstructionSetAndEveryRunGiveTheSameBytes) {
    const InstructionSet best = instructionSet();
    for (const Order order : {Order::depthFirst, Order::bestFirst}) {
        const Answers reference = ask(a, b, poses, order);
        expectSameBytes(reference, ask(a, b, poses, order));
        for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
            limitInstructionSet(set);
            SCOPED_TRACE(name(instructionSet()));
            expectSameBytes(reference, ask(a, b, poses, order));
        }
        limitInstructionSet(best);
    }
}

TEST_P(QueryLaws, StoppedAndResumedEqualsUninterrupted) {
    Random random(5);
    int stops = 0;
    for (const Order order : {Order::depthFirst, Order::bestFirst}) {
        for (const Pose& pose : poses) {
            Query whole(a, b);
            Query parts(a, b);
            const Decision expected = whole.decide(pose, DecideSettings::exact(order));
            Decision decision = parts.decide(pose, DecideSettings::exact(order), {.work = random.bits() % 4});
            while (!decision.certain) {
                ASSERT_EQ(decision.stop, StopReason::budget);
                ++stops;
                decision = parts.resume({.work = 1 + random.bits() % 4});
            }
            EXPECT_TRUE(sameBytes(decision, expected));

            const ContactSettings near{.maxDistance = 0.02F * size, .order = order};
            const Contacts all = whole.contacts(pose, near);
            Contacts some;
            parts.contacts(pose, near, {.work = random.bits() % 8}, some);
            while (!some.certain) {
                ASSERT_EQ(some.stop, StopReason::budget);
                ++stops;
                parts.resumeContacts({.work = 1 + random.bits() % 16}, some);
            }
            EXPECT_EQ(some.work, all.work);
            EXPECT_TRUE(std::ranges::equal(some.pairs, all.pairs,
                                           [](const auto& p, const auto& q) { return sameBytes(p, q); }));
        }
    }
    EXPECT_GT(stops, static_cast<int>(poses.size()));
}

TEST_P(QueryLaws, ABudgetIsKeptAndMoreOfItIsNeverWorse) {
    for (std::size_t i = 0; i < poses.size() / 3; ++i) {
        std::size_t found = 0;
        for (const std::uint64_t work : {0U, 1U, 4U, 16U, 64U, 256U}) {
            Query query(a, b);
            const Decision decision = query.decide(poses[i], DecideSettings::exact(Order::bestFirst), {.work = work});
            EXPECT_LE(decision.work, work);
            const Contacts contacts =
                query.contacts(poses[i], {.maxDistance = 0.02F * size, .order = Order::bestFirst}, {.work = work});
            EXPECT_LE(contacts.work, work);
            EXPECT_GE(contacts.pairs.size(), found);
            found = contacts.pairs.size();
        }
    }
}

TEST_P(QueryLaws, BadInputIsAStatus) {
    Query query(a, b);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    std::vector<Pose> bad(4);
    bad[0].translation.x() = nan;
    bad[1].translation.y() = infinity;
    bad[2].rotation *= 2;
    bad[3].rotation(1, 2) = nan;
    for (const Pose& pose : bad) {
        EXPECT_EQ(query.decide(pose, DecideSettings::exact()).stop, StopReason::invalidInput);
        const Contacts contacts = query.contacts(pose, {.maxDistance = 0.1F});
        EXPECT_EQ(contacts.stop, StopReason::invalidInput);
        EXPECT_TRUE(contacts.pairs.empty());
    }
    for (const float distance : {nan, -1.0F}) {
        EXPECT_EQ(query.contacts({}, {.maxDistance = distance}).stop, StopReason::invalidInput);
    }
    // ... and does not spoil the next question.
    EXPECT_EQ(query.decide(poses[0], DecideSettings::exact()).collides,
              Query(a, b).decide(poses[0], DecideSettings::exact()).collides);
}

INSTANTIATE_TEST_SUITE_P(AllPairs, QueryLaws, testing::Range(0, 4),
                         [](const auto& sample) { return lawPairs()[static_cast<std::size_t>(sample.param)].name; });

}  // namespace
}  // namespace grapeshot::test
