// What holds for every query whatever the answer: budgets, resuming, copies, symmetry, instruction sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include <grapeshot/adb/query.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"
#include "pair_cases.hpp"

namespace grapeshot::test {
namespace {

const std::vector<PairCase>& lawCases() {
    static const std::vector<PairCase> all =
        pairCases({scenes::bumpySphere(1, 0.25F, 6, 10), scenes::torusKnot(2, 3, 1, 0.5F, 0.2F, 100, 10),
                   scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2)},
                  6, static_cast<int>(sampleSize(8, 100)), 9);
    return all;
}

void expectSame(const Contacts& a, const Contacts& b) {
    EXPECT_EQ(a.certain, b.certain);
    EXPECT_EQ(a.stop, b.stop);
    EXPECT_EQ(a.work, b.work);
    ASSERT_EQ(a.pairs.size(), b.pairs.size());
    for (std::size_t i = 0; i < a.pairs.size(); ++i) {
        const TriangleContact& x = a.pairs[i];
        const TriangleContact& y = b.pairs[i];
        EXPECT_TRUE(x.pair == y.pair && x.onA == y.onA && x.onB == y.onB && x.signedDistance == y.signedDistance &&
                    x.featureA == y.featureA && x.featureB == y.featureB && x.overlapping == y.overlapping)
            << "contact " << i;
    }
}

constexpr Order orders[] = {Order::depthFirst, Order::bestFirst};

TEST(Laws, SampleIsRepresentative) {
    for (const PairCase& pair : lawCases()) {
        Query query(pair.a, pair.b);
        const auto colliding = std::count_if(pair.poses.begin(), pair.poses.end(), [&](const Pose& pose) {
            return query.decide(pose, DecideSettings::exact()).collides;
        });
        EXPECT_GT(colliding, static_cast<std::ptrdiff_t>(pair.poses.size() / 5));
        EXPECT_LT(colliding, static_cast<std::ptrdiff_t>(pair.poses.size() * 9 / 10));
    }
}

TEST(Laws, SwappedBodiesCollideAlike) {
    for (const PairCase& pair : lawCases()) {
        Query query(pair.a, pair.b);
        Query swapped(pair.b, pair.a);
        const double size = sizeOf(pair.a) + sizeOf(pair.b);
        for (const Pose& pose : pair.poses) {
            if (query.decide(pose, DecideSettings::exact()).collides !=
                swapped.decide(inverse(pose), DecideSettings::exact()).collides) {
                EXPECT_LE(std::abs(bruteForceClearance(pair.a.mesh(), pair.b.mesh(), pose)), 1e-6 * size);
            }
            const auto count = static_cast<double>(query.contacts(pose, {0.02F}).pairs.size());
            const auto countSwapped = static_cast<double>(swapped.contacts(inverse(pose), {0.02F}).pairs.size());
            EXPECT_NEAR(count, countSwapped, 1 + 0.001 * count);  // rounding at the very distance
        }
    }
}

TEST(Laws, MovingBothBodiesChangesNothing) {
    Random random(6);
    const PairCase& pair = lawCases()[0];
    Query query(pair.a, pair.b);
    for (std::size_t i = 0; i < pair.poses.size(); i += 8) {
        // The same surfaces, A's in another frame.
        const Pose frame{random.rotation(), random.direction()};
        const Tree movedA = moved(pair.a, frame);
        Query movedQuery(movedA, pair.b);
        const Pose movedPose = compose(frame, pair.poses[i]);
        if (query.decide(pair.poses[i], DecideSettings::exact()).collides !=
            movedQuery.decide(movedPose, DecideSettings::exact()).collides) {
            EXPECT_LE(std::abs(bruteForceClearance(pair.a.mesh(), pair.b.mesh(), pair.poses[i])),
                      1e-6 * (sizeOf(pair.a) + sizeOf(pair.b)));
        }
    }
}

TEST(Laws, BothOrdersEndAlike) {
    for (const PairCase& pair : lawCases()) {
        Query query(pair.a, pair.b);
        for (const Pose& pose : pair.poses) {
            EXPECT_EQ(query.decide(pose, DecideSettings::exact(Order::depthFirst)).collides,
                      query.decide(pose, DecideSettings::exact(Order::bestFirst)).collides);
            Contacts first = query.contacts(pose, {0.02F, Order::depthFirst});
            Contacts second = query.contacts(pose, {0.02F, Order::bestFirst});
            EXPECT_EQ(first.work, second.work);
            for (Contacts* contacts : {&first, &second}) {
                std::sort(contacts->pairs.begin(), contacts->pairs.end(), [](const auto& x, const auto& y) {
                    return std::pair(x.pair.triangleA, x.pair.triangleB) <
                           std::pair(y.pair.triangleA, y.pair.triangleB);
                });
            }
            expectSame(first, second);
        }
    }
}

TEST(Laws, ResumedAnywhereIsUninterrupted) {
    Random random(7);
    for (const PairCase& pair : lawCases()) {
        for (const Order order : orders) {
            Query whole(pair.a, pair.b);
            Query pieces(pair.a, pair.b);
            for (const Pose& pose : pair.poses) {
                const Decision expected = whole.decide(pose, DecideSettings::exact(order));
                std::uint64_t granted = random.bits() % 4;
                Decision decision = pieces.decide(pose, DecideSettings::exact(order), {granted});
                while (!decision.certain) {
                    EXPECT_EQ(decision.stop, StopReason::budget);
                    EXPECT_EQ(decision.work, granted);
                    EXPECT_TRUE(decision.collides);
                    EXPECT_EQ(decision.probability, 0.5F);
                    const std::uint64_t more = random.bits() % 4;
                    granted += more;
                    decision = pieces.resume({more});
                    ASSERT_LE(decision.work, expected.work);
                }
                EXPECT_TRUE(same(decision, expected));
                EXPECT_TRUE(same(pieces.resume({}), expected));
            }
        }
    }
}

TEST(Laws, ResumedContactsAreUninterrupted) {
    Random random(8);
    for (const PairCase& pair : lawCases()) {
        Query whole(pair.a, pair.b);
        Query pieces(pair.a, pair.b);
        for (std::size_t i = 0; i < pair.poses.size(); i += 4) {
            for (const Order order : orders) {
                const ContactSettings settings{0.02F, order};
                const Contacts expected = whole.contacts(pair.poses[i], settings);
                Contacts contacts = pieces.contacts(pair.poses[i], settings, {random.bits() % 30});
                std::size_t before = 0;
                while (!contacts.certain) {
                    EXPECT_GE(contacts.pairs.size(), before);  // more budget is never worse
                    before = contacts.pairs.size();
                    pieces.resumeContacts({random.bits() % 30}, contacts);
                }
                expectSame(contacts, expected);

                LeafPairs all;
                whole.leafPairs(pair.poses[i], settings, {}, all);
                LeafPairs some;
                pieces.leafPairs(pair.poses[i], settings, {random.bits() % 30}, some);
                while (!some.certain) {
                    pieces.resumeLeafPairs({random.bits() % 30}, some);
                }
                EXPECT_EQ(some.pairs, all.pairs);
                EXPECT_EQ(some.work, all.work);
            }
        }
    }
}

TEST(Laws, MoreBudgetIsNeverWorse) {
    const PairCase& pair = lawCases()[0];
    for (const Order order : orders) {
        for (std::size_t i = 0; i < pair.poses.size(); i += 4) {
            const bool truth = Query(pair.a, pair.b).decide(pair.poses[i], DecideSettings::exact()).collides;
            bool wasCertain = false;
            for (std::uint64_t work = 0; work < 200; work += 5) {
                Query query(pair.a, pair.b);
                const Decision decision = query.decide(pair.poses[i], DecideSettings::exact(order), {work});
                EXPECT_LE(decision.work, work);
                EXPECT_TRUE(decision.certain || !wasCertain);
                EXPECT_TRUE(!decision.certain || decision.collides == truth);
                wasCertain = decision.certain;
            }
        }
    }
}

TEST(Laws, NoBudgetSaysWhatIsKnown) {
    const PairCase& pair = lawCases()[0];
    Query query(pair.a, pair.b);
    for (const Budget& none :
         {Budget{0}, Budget{unlimited, std::chrono::nanoseconds(0)}, Budget{unlimited, std::chrono::nanoseconds(-5)}}) {
        const Decision decision = query.decide(Pose{}, DecideSettings::exact(), none);
        EXPECT_EQ(decision.stop, StopReason::budget);
        EXPECT_EQ(decision.work, 0U);
        EXPECT_FALSE(decision.certain);
        const Contacts contacts = query.contacts(Pose{}, {0.1F}, none);
        EXPECT_EQ(contacts.stop, StopReason::budget);
        EXPECT_EQ(contacts.work, 0U);
        EXPECT_TRUE(contacts.pairs.empty());
    }
}

std::chrono::nanoseconds tickingClock() noexcept {
    static std::chrono::nanoseconds now{0};
    now += std::chrono::nanoseconds(1000);
    return now;
}

TEST(Laws, TimeIsLookedAtEvery32Units) {
    const PairCase& pair = lawCases()[0];
    Query query(pair.a, pair.b);
    const ContactSettings settings{0.05F, Order::depthFirst};
    const Contacts all = query.contacts(Pose{Eigen::Matrix3f::Identity(), {0.3F, 0, 0}}, settings);
    ASSERT_GT(all.work, 200U);
    Contacts contacts = query.contacts(Pose{Eigen::Matrix3f::Identity(), {0.3F, 0, 0}}, settings,
                                       {unlimited, std::chrono::nanoseconds(3000), &tickingClock});
    EXPECT_EQ(contacts.work, 96U);
    EXPECT_EQ(contacts.stop, StopReason::budget);
    query.resumeContacts({40, std::chrono::nanoseconds(1'000'000), &tickingClock}, contacts);
    EXPECT_EQ(contacts.work, 136U);
    query.resumeContacts({unlimited, std::chrono::hours(1)}, contacts);
    expectSame(contacts, all);
}

TEST(Laws, ACopyResumesOnItsOwn) {
    const PairCase& pair = lawCases()[1];
    for (const Order order : orders) {
        for (std::size_t i = 0; i < pair.poses.size(); i += 5) {
            Query original(pair.a, pair.b);
            const Decision stopped = original.decide(pair.poses[i], DecideSettings::exact(order), {3});
            if (stopped.certain) {
                continue;
            }
            Query copy(original);
            Query assigned(pair.b, pair.a);
            assigned = original;
            const Decision first = original.resume({});
            EXPECT_TRUE(same(copy.resume({}), first));
            EXPECT_TRUE(same(assigned.resume({}), first));
            Query moved(std::move(copy));
            EXPECT_TRUE(same(moved.resume({}), first));
        }
    }
}

TEST(Laws, NothingToResume) {
    const PairCase& pair = lawCases()[0];
    Query query(pair.a, pair.b);
    Contacts contacts;
    LeafPairs leaves;
    EXPECT_EQ(query.resume({}).stop, StopReason::invalidInput);
    query.resumeContacts({}, contacts);
    EXPECT_EQ(contacts.stop, StopReason::invalidInput);
    (void)query.decide(Pose{}, DecideSettings::exact(), {2});
    query.resumeLeafPairs({}, leaves);
    EXPECT_EQ(leaves.stop, StopReason::invalidInput);
    EXPECT_TRUE(query.resume({}).certain);
}

TEST(Laws, EveryInstructionSetGivesTheSameBytes) {
    const InstructionSetGuard guard;
    const std::vector<InstructionSet> sets = instructionSets();
    for (const PairCase& pair : lawCases()) {
        for (const Order order : orders) {
            std::vector<Decision> decisions;
            std::vector<Contacts> contacts;
            std::vector<LeafPairs> leaves;
            for (const InstructionSet set : sets) {
                limitInstructionSet(set);
                Query query(pair.a, pair.b);
                for (std::size_t i = 0; i < pair.poses.size(); ++i) {
                    const Decision decision = query.decide(pair.poses[i], DecideSettings::exact(order));
                    const Contacts found = query.contacts(pair.poses[i], {0.01F, order}, {300});
                    LeafPairs touching;
                    query.leafPairs(pair.poses[i], {0.01F, order}, {300}, touching);
                    if (set == sets.front()) {
                        decisions.push_back(decision);
                        contacts.push_back(found);
                        leaves.push_back(touching);
                    } else {
                        EXPECT_TRUE(same(decision, decisions[i]));
                        expectSame(found, contacts[i]);
                        EXPECT_EQ(touching.pairs, leaves[i].pairs);
                        EXPECT_EQ(touching.work, leaves[i].work);
                    }
                }
            }
        }
    }
}

TEST(Laws, SameTwice) {
    for (const PairCase& pair : lawCases()) {
        Query first(pair.a, pair.b);
        Query second(pair.a, pair.b);
        for (const Pose& pose : pair.poses) {
            EXPECT_TRUE(
                same(first.decide(pose, DecideSettings::exact()), second.decide(pose, DecideSettings::exact())));
            expectSame(first.contacts(pose, {0.01F}), second.contacts(pose, {0.01F}));
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
