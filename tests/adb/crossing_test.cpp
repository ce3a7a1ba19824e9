// The curve in which two surfaces cross: exact in the end, near it before, and however long it is.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include <grapeshot/adb/crossing.hpp>
#include <grapeshot/adb/detail/crossing_cut.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "crossings.hpp"
#include "meshes.hpp"
#include "trees.hpp"

namespace grapeshot::test {
namespace {

/// Those that are in one of two lists only (both ascending) touch so little that rounding decides.
void expectSamePairs(const Tree& a, const Tree& b, const Pose& pose, const std::vector<TrianglePair>& found,
                     const std::vector<TrianglePair>& truth) {
    std::vector<TrianglePair> different;
    std::ranges::set_symmetric_difference(found, truth, std::back_inserter(different));
    for (const TrianglePair& pair : different) {
        EXPECT_LE(std::abs(triangleSeparation(cornersOf(a.mesh(), pair.triangleA),
                                              cornersOf(b.mesh(), pair.triangleB, pose))),
                  borderline(a, b, pose));
    }
}

Eigen::Vector3d normalOf(const Corners& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}

/// A proven piece is where its two triangles are, and as they cross.
void expectPieceOfItsTriangles(const Tree& a, const Tree& b, const Pose& pose, const CurvePiece& piece) {
    const Corners onA = cornersOf(a.mesh(), piece.pair.triangleA);
    const Corners onB = cornersOf(b.mesh(), piece.pair.triangleB, pose);
    const Eigen::Vector3d place = piece.position.cast<double>();
    if (piece.length > 0) {
        EXPECT_LE(triangleDistance(onA, {place, place, place}), borderline(a, b, pose));
        EXPECT_LE(triangleDistance(onB, {place, place, place}), borderline(a, b, pose));
        EXPECT_NEAR(piece.extent, piece.length / std::sqrt(12.0), 1e-6 * piece.length);
    }
    const Eigen::Vector3d normalA = normalOf(onA);
    const Eigen::Vector3d normalB = normalOf(onB);
    EXPECT_LE((piece.direction.cast<double>() - (normalB - normalA)).norm(), 1e-5);
    const double angle = std::acos(std::clamp(normalA.dot(normalB), -1.0, 1.0));  // 0: both look the same way
    EXPECT_NEAR(piece.slope, std::min(1 / std::tan(angle / 2), 30.0), 1e-3 * (1 + piece.slope * piece.slope));
}

TEST(Crossing, EndsWithAllIntersectingPairs) {
    Random random(1);
    std::size_t listed = 0;
    int none = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        Query exact(tree, tree);
        CrossingQuery query(tree, tree);
        Crossing crossing;
        for (std::size_t i = 0; i < sampleSize(6, 100); ++i) {
            const Pose pose = randomPose(tree, tree, random);
            query.find(pose, {}, {}, crossing);
            ASSERT_TRUE(crossing.certain);
            EXPECT_EQ(crossing.rate, 0);
            ASSERT_TRUE(wellFormed(crossing));
            const std::vector<TrianglePair> found = provenPairs(crossing);
            EXPECT_TRUE(std::ranges::is_sorted(found, std::less_equal())) << "ascending, each once";
            std::vector<TrianglePair> truth;
            if (i == 0) {
                truth = bruteForcePairs(tree.mesh(), tree.mesh(), pose, 0);
            } else {
                for (const TriangleContact& contact : exact.contacts(pose, {0}).pairs) {
                    truth.push_back(contact.pair);
                }
                std::ranges::sort(truth);
            }
            expectSamePairs(tree, tree, pose, found, truth);
            for (const CurvePiece& piece : crossing.pieces) {
                expectPieceOfItsTriangles(tree, tree, pose, piece);
            }
            listed += found.size();
            none += found.empty() ? 1 : 0;
        }
    }
    EXPECT_GT(listed, 1000U);
    EXPECT_GT(none, 10);
}

TEST(Crossing, ExpectedLengthIsNearTheTrueOne) {
    struct Bound {
        std::uint64_t work;
        double low, high;  ///< of the middle four fifths
    };
    // Expected over true; on full samples 0.85 to 1.24, 0.90 to 1.13 and 0.93 to 1.07, with medians 1.01, 1.00, 1.00.
    for (const auto& [work, low, high] : {Bound{8, 0.75, 1.6}, Bound{32, 0.8, 1.3}, Bound{128, 0.85, 1.15}}) {
        std::vector<double> ratios;
        for (const PairCase& pair : crossingCases()) {
            for (const Pose& pose : pair.poses) {
                const double truth = totalLength(exactCrossing(pair.a, pair.b, pose));
                if (truth > 0.2) {  // of meshes of diagonal 2
                    ratios.push_back(totalLength(crossingAfter(pair.a, pair.b, pose, work)) / truth);
                }
            }
        }
        ASSERT_GT(ratios.size(), 30U);
        std::ranges::sort(ratios);
        const auto at = [&](double part) {
            return ratios[static_cast<std::size_t>(part * static_cast<double>(ratios.size()))];
        };
        EXPECT_GE(at(0.1), low) << work;
        EXPECT_LE(at(0.9), high) << work;
        EXPECT_NEAR(at(0.5), 1, 0.1) << work;
    }
}

/// A mesh that crosses a turned twin of its own all over.
Tree denseTree() {
    return build(soup(static_cast<int>(sampleSize(1500, 4000)), 0.4F, 3).view());
}

TEST(Crossing, MoreThanTheCutHoldsEndsTheSame) {
    const Tree tree = denseTree();
    Random random(5);
    Pose pose{random.rotation(), {0, 0, 0}};
    pose.translation = Eigen::Vector3f::Constant(0.5F) - pose.rotation * Eigen::Vector3f::Constant(0.5F);

    detail::Descent descent;
    detail::StackStorage storage;
    storage.lendTo(descent);
    detail::setTrees(descent, tree, tree);
    descent.pose = pose;
    ASSERT_EQ(detail::prepare(pose, tree.radius, tree.radius, 0, descent.prepared), detail::PoseVerdict::usable);
    const auto cut = std::make_unique<detail::CrossingCut>();
    detail::startCrossing(*cut);
    const RateFormula& formula = defaultCalibration().formula;
    detail::CrossingEnd end = detail::CrossingEnd::found;
    while (end == detail::CrossingEnd::found) {
        end = detail::refineCrossing(descent, *cut, formula, 1000);
    }
    ASSERT_EQ(end, detail::CrossingEnd::full) << "not what this test is for";
    const std::uint64_t whenFull = descent.work;

    const Crossing expected = exactCrossing(tree, tree, pose);
    ASSERT_GT(expected.work, 2 * whenFull);
    ASSERT_GT(expected.pieces.size(), 1000U);
    CrossingQuery query(tree, tree);
    Crossing crossing;
    query.find(pose, {.leaveOut = 0}, {whenFull + 3}, crossing);
    std::vector<TrianglePair> before;
    while (!crossing.certain) {
        ASSERT_TRUE(wellFormed(crossing));
        std::vector<TrianglePair> now = provenPairs(crossing);
        ASSERT_LE(crossing.pieces.size() - now.size(), 16 * detail::crossingBlocks);
        std::ranges::sort(now);
        ASSERT_TRUE(std::ranges::includes(now, before));
        before = now;
        CrossingQuery copy(query);
        copy.resume({random.bits() % 4000}, crossing);
        query = copy;
    }
    EXPECT_TRUE(same(crossing, expected));

    const InstructionSetGuard guard;
    std::vector<Crossing> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        std::size_t next = 0;
        for (const std::uint64_t work : {whenFull - 1, whenFull, whenFull + 1, whenFull + 700, whenFull + 5000}) {
            const Crossing stopped = crossingAfter(tree, tree, pose, work, 0.05F);
            ASSERT_FALSE(stopped.certain);
            if (first.size() <= next) {
                first.push_back(stopped);
            }
            ASSERT_TRUE(same(stopped, first[next++])) << work;
        }
    }
}

TEST(Crossing, LeavesOutTheShortest) {
    std::size_t leftOut = 0;
    for (const PairCase& pair : crossingCases()) {
        for (std::size_t i = 0; i < pair.poses.size(); i += 2) {
            for (const std::uint64_t work : {3, 30, 150}) {
                const Crossing all = crossingAfter(pair.a, pair.b, pair.poses[i], work, 0);
                if (all.certain) {
                    continue;
                }
                const auto unproven = [](const Crossing& crossing) {
                    return crossing.pieces.size() - provenPairs(crossing).size();
                };
                for (const float part : {0.01F, 0.05F, 0.3F, 0.9F, 1.0F}) {
                    const Crossing some = crossingAfter(pair.a, pair.b, pair.poses[i], work, part);
                    EXPECT_EQ(some.rate, all.rate);
                    ASSERT_EQ(provenPairs(some), provenPairs(all));
                    EXPECT_GE(totalLength(some), (1 - part) * totalLength(all) * 0.9999);
                    leftOut += all.pieces.size() - some.pieces.size();
                    if (part == 1) {
                        EXPECT_EQ(unproven(some), 0U);
                        continue;
                    }
                    // Those told of are the same pieces, and none that was left out is longer.
                    auto next = all.pieces.begin();
                    float longestLeftOut = 0;
                    float shortestTold = 1e9F;
                    for (const CurvePiece& piece : some.pieces) {
                        while (next != all.pieces.end() && next->position != piece.position) {
                            longestLeftOut = std::max(longestLeftOut, next++->length);
                        }
                        ASSERT_NE(next, all.pieces.end());
                        EXPECT_EQ(next->length, piece.length);
                        shortestTold = piece.proven() ? shortestTold : std::min(shortestTold, piece.length);
                        ++next;
                    }
                    EXPECT_LE(longestLeftOut, shortestTold);
                }
            }
        }
    }
    EXPECT_GT(leftOut, 1000U);
}

}  // namespace
}  // namespace grapeshot::test
