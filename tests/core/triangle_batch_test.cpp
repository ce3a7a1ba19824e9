#include <grapeshot/core/triangle_batch.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/instruction_set.hpp>
#include <support/test_size.hpp>

#include "triangle_pairs.hpp"

namespace grapeshot::test {
namespace {

/// Runs on every set the machine has, and puts the best back.
template <class Body>
void onEverySet(Body body) {
    InstructionSet last = InstructionSet::avx512;
    for (const InstructionSet wish : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
        const InstructionSet got = limitInstructionSet(wish);
        if (wish == InstructionSet::scalar || got != last) {
            body(got);
        }
        last = got;
    }
    limitInstructionSet(InstructionSet::avx512);
}

std::string bytesOf(const DistanceBatch& batch) {
    std::string bytes;
    const auto add = [&](const auto& part) { bytes.append(reinterpret_cast<const char*>(&part), sizeof(part)); };
    add(batch.signedDistance);
    add(batch.onA);
    add(batch.onB);
    add(batch.featureA);
    add(batch.featureB);
    add(batch.overlapping);
    return bytes;
}

bool bit(std::uint32_t mask, int lane) {
    return (mask >> static_cast<unsigned>(lane) & 1U) != 0U;
}

Eigen::Vector3d pointOf(const float (&points)[3][batchWidth], int lane) {
    return Eigen::Vector3f(points[0][lane], points[1][lane], points[2][lane]).cast<double>();
}

/// Distance of a point from a triangle, by the oracle (a triangle that is a point).
double distanceTo(const Eigen::Vector3d& point, const TriangleF& triangle) {
    return triangleDistance({point, point, point}, toCorners(triangle));
}

class EveryKind : public testing::TestWithParam<PairKind> {};

INSTANTIATE_TEST_SUITE_P(TriangleBatch, EveryKind, testing::ValuesIn(allKinds),
                         [](const auto& kind) { return std::string(nameOf(kind.param)); });

TEST_P(EveryKind, SameBytesOnEveryInstructionSet) {
    Random random(11);
    for (std::size_t round = 0; round < sampleSize(300, 20000); ++round) {
        PairBatch batch = makeBatch(GetParam(), random);
        // Also far outside the range that single precision can decide in.
        const float scale = std::array{1.0F, 1.0F, 1e-20F, 1e-7F, 1e9F, 5e14F}[round % 6];
        for (TriangleBatch* side : {&batch.a, &batch.b}) {
            for (auto& corner : side->corner) {
                for (auto& axis : corner) {
                    for (float& x : axis) {
                        x *= scale;
                    }
                }
            }
        }
        std::vector<std::uint32_t> masks;
        std::vector<std::string> bytes;
        onEverySet([&](InstructionSet) {
            DistanceBatch out;
            signedDistances(batch.a, batch.b, out);
            masks.push_back(overlaps(batch.a, batch.b));
            bytes.push_back(bytesOf(out));
            EXPECT_EQ(out.overlapping, masks.back());
            for (int lane = 0; lane < batchWidth; ++lane) {
                EXPECT_TRUE(std::isfinite(out.signedDistance[lane]));
                EXPECT_TRUE(pointOf(out.onA, lane).allFinite());
                EXPECT_TRUE(pointOf(out.onB, lane).allFinite());
                EXPECT_TRUE(out.featureA[lane] >= 0 && out.featureA[lane] <= 6);
                EXPECT_TRUE(out.featureB[lane] >= 0 && out.featureB[lane] <= 6);
            }
        });
        ASSERT_THAT(masks, testing::Each(masks.front()));
        ASSERT_THAT(bytes, testing::Each(bytes.front()));
    }
}

TEST_P(EveryKind, OverlapIsTheOracles) {
    Random random(12);
    std::size_t yes = 0;
    std::size_t no = 0;
    for (std::size_t round = 0; round < sampleSize(1000, 50000); ++round) {
        const PairBatch batch = makeBatch(GetParam(), random);
        const std::uint32_t mask = overlaps(batch.a, batch.b);
        for (int lane = 0; lane < batchWidth; ++lane) {
            const TrianglePairF& pair = batch.pairs[lane];
            const bool truth = trianglesOverlap(toCorners(pair.a), toCorners(pair.b));
            (truth ? yes : no) += 1;
            if (bit(mask, lane) != truth) {
                EXPECT_LE(triangleSeparation(toCorners(pair.a), toCorners(pair.b)), 1e-6 * extentOf(pair))
                    << "round " << round << " lane " << lane << ", truly " << truth;
            }
        }
    }
    EXPECT_GT(yes, (yes + no) / 1000) << "the sample hardly overlaps";
    EXPECT_GT(no, (yes + no) / 10) << "the sample overlaps nearly always";
}

TEST_P(EveryKind, DistanceIsTheOracles) {
    Random random(13);
    for (std::size_t round = 0; round < sampleSize(600, 50000); ++round) {
        const PairBatch batch = makeBatch(GetParam(), random);
        DistanceBatch out;
        signedDistances(batch.a, batch.b, out);
        for (int lane = 0; lane < batchWidth; ++lane) {
            const TrianglePairF& pair = batch.pairs[lane];
            const Corners a = toCorners(pair.a);
            const Corners b = toCorners(pair.b);
            const bool truth = trianglesOverlap(a, b);
            const double separation = triangleSeparation(a, b);
            const double extent = extentOf(pair);
            if (truth != bit(out.overlapping, lane)) {
                EXPECT_LE(separation, 1e-6 * extent);
                continue;
            }
            const double expected = truth ? -separation : separation;
            EXPECT_NEAR(static_cast<double>(out.signedDistance[lane]), expected, 1e-5 * extent)
                << "round " << round << " lane " << lane;
            const Eigen::Vector3d onA = pointOf(out.onA, lane);
            const Eigen::Vector3d onB = pointOf(out.onB, lane);
            // The witnesses lie on the triangles, and the distance is theirs. Where a sliver is cut, the middle is only
            // as good as its plane.
            const double tolerance = (truth ? 1.5e-4 : 2e-6) * extent;
            EXPECT_LE(distanceTo(onA, pair.a), tolerance) << "round " << round << " lane " << lane;
            EXPECT_LE(distanceTo(onB, pair.b), tolerance) << "round " << round << " lane " << lane;
            EXPECT_NEAR((onA - onB).norm(), truth ? 0.0 : expected, 1e-5 * extent);
        }
    }
}

TEST_P(EveryKind, SwappedTrianglesSwapTheAnswer) {
    Random random(14);
    for (std::size_t round = 0; round < sampleSize(300, 20000); ++round) {
        const PairBatch batch = makeBatch(GetParam(), random);
        DistanceBatch forth;
        DistanceBatch back;
        signedDistances(batch.a, batch.b, forth);
        signedDistances(batch.b, batch.a, back);
        for (int lane = 0; lane < batchWidth; ++lane) {
            const double extent = extentOf(batch.pairs[lane]);
            EXPECT_NEAR(forth.signedDistance[lane], back.signedDistance[lane], 1e-5 * extent);
            if (bit(forth.overlapping, lane) != bit(back.overlapping, lane)) {
                EXPECT_LE(std::abs(forth.signedDistance[lane]), 1e-6 * extent);
            }
        }
    }
}

TEST_P(EveryKind, RigidMotionChangesNothing) {
    Random random(15);
    for (std::size_t round = 0; round < sampleSize(300, 20000); ++round) {
        const PairBatch batch = makeBatch(GetParam(), random);
        const Eigen::Matrix3d turn = random.rotation().cast<double>();
        const Eigen::Vector3d shift(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
        std::vector<TrianglePairF> movedPairs(batch.pairs.begin(), batch.pairs.end());
        for (TrianglePairF& pair : movedPairs) {
            for (TriangleF* triangle : {&pair.a, &pair.b}) {
                for (Eigen::Vector3f& corner : *triangle) {
                    corner = (turn * corner.cast<double>() + shift).cast<float>();
                }
            }
        }
        const PairBatch moved = toBatch(movedPairs);
        DistanceBatch here;
        DistanceBatch there;
        signedDistances(batch.a, batch.b, here);
        signedDistances(moved.a, moved.b, there);
        for (int lane = 0; lane < batchWidth; ++lane) {
            // The moved corners are rounded, at coordinates up to about 4.
            EXPECT_NEAR(here.signedDistance[lane], there.signedDistance[lane],
                        1e-5 * extentOf(batch.pairs[lane]) + 4e-6);
        }
    }
}

TEST_P(EveryKind, LanesDoNotSeeEachOther) {
    Random random(16);
    for (std::size_t round = 0; round < sampleSize(50, 2000); ++round) {
        const PairBatch batch = makeBatch(GetParam(), random);
        DistanceBatch together;
        signedDistances(batch.a, batch.b, together);
        const std::uint32_t mask = overlaps(batch.a, batch.b);
        for (int lane = 0; lane < batchWidth; ++lane) {
            // Alone among far-away pairs that are decided at once, and in another lane.
            const TrianglePairF easy{{Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0)},
                                     {Eigen::Vector3f(0, 0, 9), Eigen::Vector3f(1, 0, 9), Eigen::Vector3f(0, 1, 9)}};
            std::vector<TrianglePairF> pairs(batchWidth, easy);
            const int other = (lane + 5) % batchWidth;
            pairs[static_cast<std::size_t>(other)] = batch.pairs[lane];
            const PairBatch alone = toBatch(pairs);
            DistanceBatch single;
            signedDistances(alone.a, alone.b, single);
            EXPECT_EQ(bit(overlaps(alone.a, alone.b), other), bit(mask, lane));
            EXPECT_EQ(std::memcmp(&single.signedDistance[other], &together.signedDistance[lane], sizeof(float)), 0);
            EXPECT_EQ(single.featureA[other], together.featureA[lane]);
            EXPECT_EQ(single.featureB[other], together.featureB[lane]);
            EXPECT_EQ(pointOf(single.onA, other), pointOf(together.onA, lane));
            EXPECT_EQ(pointOf(single.onB, other), pointOf(together.onB, lane));
        }
    }
}

TEST(TriangleBatch, FeaturesAreThoseOfTheWitnesses) {
    Random random(17);
    std::array<std::size_t, 7> seen{};
    for (std::size_t round = 0; round < sampleSize(500, 20000); ++round) {
        const PairBatch batch = makeBatch(PairKind::anywhere, random);
        DistanceBatch out;
        signedDistances(batch.a, batch.b, out);
        for (int lane = 0; lane < batchWidth; ++lane) {
            if (bit(out.overlapping, lane)) {
                continue;
            }
            const auto check = [&](const TriangleF& triangle, std::int32_t feature, const Eigen::Vector3d& point) {
                ++seen[static_cast<std::size_t>(feature)];
                const auto corner = [&](int i) -> Eigen::Vector3d { return triangle[i % 3].cast<double>(); };
                if (feature < 3) {
                    EXPECT_LE((point - corner(feature)).norm(), 2e-6);
                } else if (feature < 6) {
                    const Eigen::Vector3d start = corner(feature - 3);
                    const Eigen::Vector3d end = corner(feature - 2);
                    EXPECT_NEAR((point - start).norm() + (end - point).norm(), (end - start).norm(), 2e-6);
                }
            };
            check(batch.pairs[lane].a, out.featureA[lane], pointOf(out.onA, lane));
            check(batch.pairs[lane].b, out.featureB[lane], pointOf(out.onB, lane));
        }
    }
    EXPECT_THAT(seen, testing::Each(testing::Gt(100U)));
}

TEST(TriangleBatch, TouchingCountsAsOverlapping) {
    const TriangleF base = {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(2, 0, 0), Eigen::Vector3f(0, 2, 0)};
    const std::vector<TrianglePairF> touching = {
        {base, {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(-1, 0, 1), Eigen::Vector3f(0, -1, 1)}},  // corner on corner
        {base, {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(1, -1, 1), Eigen::Vector3f(1, -1, 2)}},  // corner on edge
        {base, {Eigen::Vector3f(0.5F, 0.5F, 0), Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(1, 0, 1)}},  // corner on face
        {base, {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(2, 0, 0), Eigen::Vector3f(0, -2, 0)}},       // shared edge
        {base, {Eigen::Vector3f(1, -1, -1), Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(3, 0, 0)}},      // edge on edge
        {base, base},
    };
    const std::vector<TrianglePairF> apart = {
        {base, {Eigen::Vector3f(0, 0, 1e-5F), Eigen::Vector3f(2, 0, 1e-5F), Eigen::Vector3f(0, 2, 1e-5F)}},
        {base, {Eigen::Vector3f(2, 2, 0), Eigen::Vector3f(2, 0.0001F, 0), Eigen::Vector3f(3, 0, 0)}},  // coplanar
    };
    for (const TrianglePairF& pair : touching) {
        const PairBatch batch = toBatch(std::span(&pair, 1));
        EXPECT_EQ(overlaps(batch.a, batch.b), 0xffffU) << &pair - touching.data();
        DistanceBatch out;
        signedDistances(batch.a, batch.b, out);
        EXPECT_LE(std::abs(out.signedDistance[0]), 1e-6F) << &pair - touching.data();
    }
    for (const TrianglePairF& pair : apart) {
        const PairBatch batch = toBatch(std::span(&pair, 1));
        EXPECT_EQ(overlaps(batch.a, batch.b), 0U) << &pair - apart.data();
    }
}

/// The decision is about the triangles, not about how far they are from the origin or how large they are.
TEST(TriangleBatch, FarAwayAndScaledPairsKeepTheirAnswer) {
    Random random(18);
    std::size_t checked = 0;
    for (std::size_t round = 0; round < sampleSize(200, 5000); ++round) {
        const PairBatch batch = makeBatch(PairKind::anywhere, random);
        const std::uint32_t mask = overlaps(batch.a, batch.b);
        for (const float scale : {0x1p-60F, 0x1p-20F, 0x1p20F, 0x1p49F}) {  // exact in binary
            TriangleBatch a = batch.a;
            TriangleBatch b = batch.b;
            for (TriangleBatch* side : {&a, &b}) {
                for (float& x : std::span(&side->corner[0][0][0], 9 * batchWidth)) {
                    x *= scale;
                }
            }
            DistanceBatch plain;
            DistanceBatch scaled;
            signedDistances(batch.a, batch.b, plain);
            signedDistances(a, b, scaled);
            const std::uint32_t scaledMask = overlaps(a, b);
            for (int lane = 0; lane < batchWidth; ++lane) {
                ++checked;
                const float here = plain.signedDistance[lane];
                EXPECT_NEAR(scaled.signedDistance[lane] / scale, here, 2e-6F) << scale;
                if (bit(mask, lane) != bit(scaledMask, lane)) {
                    EXPECT_LE(std::abs(here), 1e-6F);
                }
            }
        }
    }
    EXPECT_GT(checked, 10000U);
}

TEST(TriangleBatch, LeavesAreTheSixteenCombinations) {
    Random random(19);
    std::size_t overlapping = 0;
    for (std::size_t round = 0; round < sampleSize(500, 20000); ++round) {
        const PairKind kind = allKinds[round % allKinds.size()];
        std::array<TrianglePairF, 4> pairs;
        detail::FourTriangles a;
        detail::FourTriangles b;
        const Pose pose{random.rotation(), random.direction() * static_cast<float>(random.uniform(0, 0.7))};
        for (int k = 0; k < 4; ++k) {
            pairs[k] = makePair(kind, random);
            for (int corner = 0; corner < 3; ++corner) {
                const Eigen::Vector3f inB = apply(inverse(pose), pairs[k].b[corner]);
                for (int axis = 0; axis < 3; ++axis) {
                    a[corner][axis][k] = pairs[k].a[corner][axis];
                    b[corner][axis][k] = inB[axis];
                }
            }
        }
        std::vector<TrianglePairF> sixteen;
        for (int lane = 0; lane < batchWidth; ++lane) {
            TrianglePairF pair = pairs[lane / 4];
            for (int corner = 0; corner < 3; ++corner) {
                const float x = b[corner][0][lane % 4];
                const float y = b[corner][1][lane % 4];
                const float z = b[corner][2][lane % 4];
                for (int axis = 0; axis < 3; ++axis) {
                    const auto row = pose.rotation.row(axis);
                    pair.b[corner][axis] = row[0] * x + row[1] * y + row[2] * z + pose.translation[axis];
                }
            }
            sixteen.push_back(pair);
        }
        const PairBatch batch = toBatch(sixteen);
        onEverySet([&](InstructionSet set) {
            const std::uint32_t mask = overlaps(batch.a, batch.b);
            overlapping += static_cast<std::size_t>(std::popcount(mask));
            EXPECT_EQ(detail::overlapsLeaves(a, b, pose), mask) << name(set);
            DistanceBatch expected;
            DistanceBatch out;
            signedDistances(batch.a, batch.b, expected);
            detail::signedDistancesLeaves(a, b, pose, out);
            EXPECT_EQ(bytesOf(out), bytesOf(expected)) << name(set) << " round " << round;
        });
    }
    EXPECT_GT(overlapping, 1000U);
}

TEST(TriangleBatch, LeavesWithinADistance) {
    Random random(20);
    std::size_t within = 0;
    std::size_t skipped = 0;
    for (std::size_t round = 0; round < sampleSize(1000, 50000); ++round) {
        detail::FourTriangles a;
        detail::FourTriangles b;
        const float size = static_cast<float>(random.uniform(0.05, 1));
        for (int k = 0; k < 4; ++k) {
            const TrianglePairF pair = makePair(PairKind::anywhere, random);
            for (int corner = 0; corner < 3; ++corner) {
                for (int axis = 0; axis < 3; ++axis) {
                    a[corner][axis][k] = size * pair.a[corner][axis];
                    b[corner][axis][k] = size * pair.b[corner][axis];
                }
            }
        }
        const Pose pose{random.rotation(), random.direction()};
        const auto limit = static_cast<float>(random.uniform(0, 0.3));
        DistanceBatch all;
        detail::signedDistancesLeaves(a, b, pose, all);
        std::vector<std::string> bytes;
        onEverySet([&](InstructionSet) {
            DistanceBatch out;
            detail::signedDistancesLeaves(a, b, pose, out, limit);
            bytes.push_back(bytesOf(out));
            for (int lane = 0; lane < batchWidth; ++lane) {
                if (out.signedDistance[lane] == std::numeric_limits<float>::max()) {
                    ++skipped;
                    EXPECT_GT(all.signedDistance[lane], limit);
                    EXPECT_FALSE(bit(all.overlapping, lane));
                    EXPECT_FALSE(bit(out.overlapping, lane));
                } else {
                    within += all.signedDistance[lane] <= limit ? 1U : 0U;
                    EXPECT_EQ(out.signedDistance[lane], all.signedDistance[lane]);
                    EXPECT_EQ(pointOf(out.onA, lane), pointOf(all.onA, lane));
                    EXPECT_EQ(pointOf(out.onB, lane), pointOf(all.onB, lane));
                    EXPECT_EQ(out.featureA[lane], all.featureA[lane]);
                    EXPECT_EQ(bit(out.overlapping, lane), bit(all.overlapping, lane));
                }
            }
        });
        EXPECT_THAT(bytes, testing::Each(bytes.front()));
    }
    EXPECT_GT(within, 1000U);
    EXPECT_GT(skipped, 1000U);
}

}  // namespace
}  // namespace grapeshot::test
