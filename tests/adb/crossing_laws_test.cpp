// What holds for the curve of two surfaces wherever it is: budgets, resuming, copies, symmetry, instruction sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include <grapeshot/adb/crossing.hpp>
#include <support/poses.hpp>

#include "crossings.hpp"
#include "meshes.hpp"

namespace grapeshot::test {
namespace {

TEST(CrossingLaws, StoppedAndResumedEndsTheSame) {
    Random random(2);
    int crossingPoses = 0;
    int apart = 0;
    for (const PairCase& pair : crossingCases()) {
        CrossingQuery whole(pair.a, pair.b);
        CrossingQuery pieces(pair.a, pair.b);
        for (const Pose& pose : pair.poses) {
            Crossing expected;
            whole.find(pose, {}, {}, expected);
            ++(expected.pieces.empty() ? apart : crossingPoses);
            const std::uint64_t most = std::uint64_t{2} << random.bits() % 8;
            std::uint64_t granted = random.bits() % most;
            Crossing crossing;
            pieces.find(pose, {}, {granted}, crossing);
            std::vector<TrianglePair> before;
            while (!crossing.certain) {
                ASSERT_EQ(crossing.stop, StopReason::budget);
                ASSERT_EQ(crossing.work, granted);
                ASSERT_TRUE(wellFormed(crossing));
                std::vector<TrianglePair> now = provenPairs(crossing);
                std::ranges::sort(now);
                ASSERT_TRUE(std::ranges::includes(now, before)) << "a proven pair was lost";
                before = now;
                const std::uint64_t more = random.bits() % most;
                granted += more;
                pieces.resume({more}, crossing);
            }
            ASSERT_TRUE(same(crossing, expected));
            ASSERT_TRUE(std::ranges::includes(provenPairs(crossing), before));
            pieces.resume({}, crossing);
            ASSERT_TRUE(same(crossing, expected));
        }
    }
    EXPECT_GT(crossingPoses, 30);
    EXPECT_GT(apart, 20);
}

TEST(CrossingLaws, WhereItWasStoppedDoesNotMatter) {
    Random random(3);
    for (const PairCase& pair : crossingCases()) {
        CrossingQuery query(pair.a, pair.b);
        for (std::size_t i = 0; i < pair.poses.size(); i += 4) {
            const std::uint64_t work = 1 + random.bits() % 100;
            const Crossing atOnce = crossingAfter(pair.a, pair.b, pair.poses[i], work);
            Crossing inPieces;
            query.find(pair.poses[i], {.leaveOut = 0}, {work / 3}, inPieces);
            query.resume({work / 5}, inPieces);
            query.resume({work - work / 3 - work / 5}, inPieces);
            ASSERT_TRUE(same(inPieces, atOnce)) << work;
        }
    }
}

TEST(CrossingLaws, ACopyResumesOnItsOwn) {
    const PairCase& pair = crossingCases()[0];
    int resumed = 0;
    for (std::size_t i = 0; i < pair.poses.size(); i += 3) {
        CrossingQuery original(pair.a, pair.b);
        Crossing first;
        original.find(pair.poses[i], {}, {20}, first);
        CrossingQuery copy(original);
        CrossingQuery assigned(pair.b, pair.a);
        Crossing other;
        assigned.find(pair.poses[0], {}, {3}, other);
        assigned = original;
        resumed += first.certain ? 0 : 1;
        original.resume({50}, first);
        original.resume({}, first);
        original.find(pair.poses[i + 1], {}, {}, other);  // uses its own memory
        Crossing second;
        copy.resume({7}, second);
        CrossingQuery moved(std::move(copy));
        CrossingQuery ofMoved(moved);
        moved.resume({}, second);
        EXPECT_TRUE(same(second, first));
        ofMoved.resume({}, second);
        EXPECT_TRUE(same(second, first));
        copy = assigned;  // moved from, and whole again
        assigned.resume({}, second);
        EXPECT_TRUE(same(second, first));
        copy.resume({}, second);
        EXPECT_TRUE(same(second, first));
    }
    EXPECT_GT(resumed, 5);
}

TEST(CrossingLaws, SameBytesOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    const std::vector<InstructionSet> sets = instructionSets();
    for (const PairCase& pair : crossingCases()) {
        std::vector<Crossing> first;
        for (const InstructionSet set : sets) {
            limitInstructionSet(set);
            std::size_t next = 0;
            for (std::size_t i = 0; i < pair.poses.size(); i += 3) {
                for (const std::uint64_t work : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{60}, unlimited}) {
                    for (const float leaveOut : {0.0F, 0.05F}) {
                        const Crossing crossing = crossingAfter(pair.a, pair.b, pair.poses[i], work, leaveOut);
                        if (set == sets.front()) {
                            first.push_back(crossing);
                        } else {
                            ASSERT_TRUE(same(crossing, first[next])) << i << " after " << work;
                        }
                        ++next;
                    }
                }
            }
        }
    }
}

/// Pieces of the same curve, seen from another frame: `toHere` takes them back.
void expectSameCurve(const Crossing& here, const Crossing& there, const Pose& toHere, bool swapped) {
    std::map<TrianglePair, const CurvePiece*> byPair;
    for (const CurvePiece& piece : here.pieces) {
        byPair[piece.pair] = &piece;
    }
    EXPECT_NEAR(totalLength(here), totalLength(there), 1e-4 * totalLength(here) + 1e-5);
    for (const CurvePiece& piece : there.pieces) {
        const auto found = byPair.find(swapped ? TrianglePair{piece.pair.triangleB, piece.pair.triangleA} : piece.pair);
        if (found == byPair.end()) {
            EXPECT_LE(piece.length, 2e-3) << "only here";  // such a crossing is borne by rounding
            continue;
        }
        const CurvePiece& twin = *found->second;
        const float sign = swapped ? -1 : 1;
        EXPECT_LE((sign * (toHere.rotation * piece.direction) - twin.direction).norm(), 1e-4);
        if (piece.slope > 0.05F && piece.slope < 20) {  // not nearly parallel
            EXPECT_LE((apply(toHere, piece.position) - twin.position).norm(), 1e-4);
            EXPECT_NEAR(piece.length, twin.length, 1e-4);
        }
    }
}

TEST(CrossingLaws, SwappedBodiesCrossAlike) {
    std::size_t compared = 0;
    for (const PairCase& pair : crossingCases()) {
        for (const Pose& pose : pair.poses) {
            const Crossing here = exactCrossing(pair.a, pair.b, pose);
            const Crossing there = exactCrossing(pair.b, pair.a, inverse(pose));
            expectSameCurve(here, there, pose, true);
            compared += here.pieces.size();
        }
    }
    EXPECT_GT(compared, 1000U);
}

TEST(CrossingLaws, MovingBothBodiesMovesTheCurve) {
    Random random(6);
    std::size_t compared = 0;
    for (const PairCase& pair : crossingCases()) {
        for (std::size_t i = 0; i < pair.poses.size(); i += 8) {
            const Pose frame{random.rotation(), random.direction()};
            const Crossing here = exactCrossing(pair.a, pair.b, pair.poses[i]);
            const Crossing there = exactCrossing(moved(pair.a, frame), pair.b, compose(frame, pair.poses[i]));
            expectSameCurve(here, there, inverse(frame), false);
            compared += here.pieces.size();
        }
    }
    EXPECT_GT(compared, 200U);
}

}  // namespace
}  // namespace grapeshot::test
