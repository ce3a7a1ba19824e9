// The closest features against every pair of triangles in double precision, and the laws that they keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/closest_features.hpp>

#include <adb/meshes.hpp>
#include <scf/continuous_scenes.hpp>
#include <scf/tracked_scenes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

/// B beside A, by `gap` or more apart.
Pose closestBeside(double gap, Random& random) {
    return {random.rotation(), (1.2F + static_cast<float>(gap)) * random.direction()};
}

double closestOracle(MeshView a, MeshView b, const Pose& bInA) {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
        const Corners one = cornersOf(a, i);
        for (std::uint32_t j = 0; j < b.triangles.size(); ++j) {
            const Corners other = cornersOf(b, j, bInA);
            // No triangle is farther away than its first corner, by more than its edges.
            const double reach = (one[1] - one[0]).norm() + (one[2] - one[0]).norm() + (other[1] - other[0]).norm() +
                                 (other[2] - other[0]).norm();
            if ((one[0] - other[0]).norm() - reach <= least) {
                least = std::min(least, triangleDistance(one, other));
            }
        }
    }
    return least;
}

std::vector<std::byte> closestBytes(const ClosestResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    for (const FeaturePair& pair : result.pairs) {
        writer.put(pair.pair.triangleA);
        writer.put(pair.pair.triangleB);
        writer.put(pair.onA);
        writer.put(pair.onB);
        writer.put(pair.normal);
        writer.put(pair.signedDistance);
        writer.put(pair.featureA);
        writer.put(pair.featureB);
    }
    writer.put(result.atLeast);
    writer.put(result.certain);
    writer.put(result.stop);
    writer.put(result.work);
    return bytes;
}

TEST(ClosestFeatures, TheDistanceIsTheOraclesOnEveryKindOfMesh) {
    Random random(31);
    int apart = 0;
    for (std::size_t i = 0; i < everyKind().size(); ++i) {
        const NamedMesh& one = everyKind()[i];
        const NamedMesh& other = everyKind()[(i + 1) % everyKind().size()];
        const BallTree a = buildBallTree(one.mesh.view());
        const BallTree b = buildBallTree(other.mesh.view());
        ClosestQuery query(a, b);
        ClosestQuery swapped(b, a);
        for (std::size_t pose = 0; pose < sampleSize(2, 12); ++pose) {
            const Pose bInA = closestBeside(random.uniform(0, 1), random);
            const double truth = closestOracle(one.mesh.view(), other.mesh.view(), bInA);
            const ClosestResult result = query.find({}, rigidState(bInA));
            ASSERT_TRUE(result.certain) << one.name;
            ASSERT_EQ(result.pairs.size(), 1U);
            const FeaturePair& pair = result.pairs[0];
            const ClosestResult back = swapped.find(rigidState(bInA), SurfaceState{});
            ASSERT_EQ(back.pairs.size(), 1U);
            EXPECT_EQ(pair.overlapping, truth == 0) << one.name;
            EXPECT_EQ(back.pairs[0].overlapping, truth == 0);
            if (truth == 0) {
                continue;
            }
            ++apart;
            EXPECT_NEAR(static_cast<double>(pair.signedDistance), truth, 3e-6) << one.name << ' ' << other.name;
            EXPECT_NEAR(pair.signedDistance, back.pairs[0].signedDistance, 2e-6F);
            EXPECT_EQ(result.atLeast, pair.signedDistance);
            // The points are on the triangles, and as far apart as is said, along the normal.
            EXPECT_LT((pair.onA - pair.onB - pair.signedDistance * pair.normal).norm(), 4e-6F);
            const Eigen::Vector3d onA = pair.onA.cast<double>();
            const Eigen::Vector3d onB = pair.onB.cast<double>();
            EXPECT_LT(triangleDistance(cornersOf(one.mesh.view(), pair.pair.triangleA), {onA, onA, onA}), 2e-6);
            EXPECT_LT(triangleDistance(cornersOf(other.mesh.view(), pair.pair.triangleB, bInA), {onB, onB, onB}), 2e-6);
        }
    }
    EXPECT_GT(apart, 15);
}

TEST(ClosestFeatures, TheFeaturesAreWhereThePointsAre) {
    const NamedMesh& kind = everyKind()[0];
    const BallTree tree = buildBallTree(kind.mesh.view());
    const BallTree other = buildBallTree(everyKind()[12].mesh.view());
    ClosestQuery pairs(tree, other);
    Random random(5);
    for (int pose = 0; pose < 200; ++pose) {
        const Pose bInA = closestBeside(0.4, random);
        const ClosestResult result = pairs.find({}, rigidState(bInA));
        const FeaturePair& pair = result.pairs.at(0);
        const Triangle& corners = kind.mesh.triangles[pair.pair.triangleA];
        const auto corner = [&](unsigned i) { return kind.mesh.vertices[corners[i % 3]]; };
        if (pair.featureA < 3) {
            EXPECT_LT((corner(pair.featureA) - pair.onA).norm(), 1e-5F);
        } else if (pair.featureA < 6) {
            const Eigen::Vector3f from = corner(pair.featureA - 3U);
            const Eigen::Vector3f to = corner(pair.featureA - 2U);
            EXPECT_NEAR((from - pair.onA).norm() + (to - pair.onA).norm(), (from - to).norm(), 1e-5F);
        }
    }
}

TEST(ClosestFeatures, MovedAsAWholeTheDistanceStays) {
    const PassingPair scene;
    ClosestQuery query(scene.a, scene.b);
    Random random(8);
    for (int i = 0; i < 20; ++i) {
        const Pose bInA = closestBeside(0.3, random);
        const Pose world{random.rotation(), 2 * random.direction()};
        const ClosestResult here = query.find({}, rigidState(bInA));
        const ClosestResult there = query.find(rigidState(world), rigidState(compose(world, bInA)));
        EXPECT_NEAR(here.pairs.at(0).signedDistance, there.pairs.at(0).signedDistance, 4e-6F);
    }
}

TEST(ClosestFeatures, FromWhatWasClosestBeforeItIsTheSameDistance) {
    const TwoBumpy scene(16);
    ClosestQuery query(scene.a, scene.b);
    std::vector<TrianglePair> known;
    std::uint64_t cold = 0;
    std::uint64_t warm = 0;
    int nearer = 0;
    for (int frame = 0; frame < 20; ++frame) {
        TwoBumpy::Frame where = scene.at(frame);
        for (Eigen::Vector3f& vertex : where.b) {
            vertex[0] += 0.4F;
        }
        const ClosestResult fresh = query.find(where.stateA(), where.stateB());
        const ClosestResult followed = query.find(where.stateA(), where.stateB(), {}, known);
        ASSERT_TRUE(fresh.certain && followed.certain);
        EXPECT_NEAR(fresh.pairs.at(0).signedDistance, followed.pairs.at(0).signedDistance, 1e-6F);
        if (frame > 0) {
            cold += fresh.work;
            warm += followed.work;
            const ClosestResult little = query.find(where.stateA(), where.stateB(), {}, {}, {.work = 12});
            const ClosestResult littleWarm = query.find(where.stateA(), where.stateB(), {}, known, {.work = 12});
            ASSERT_EQ(littleWarm.pairs.size(), 1U);
            nearer +=
                little.pairs.empty() || littleWarm.pairs[0].signedDistance <= little.pairs[0].signedDistance + 1e-6F
                    ? 1
                    : 0;
        }
        known.assign(1, fresh.pairs[0].pair);
    }
    EXPECT_LE(warm, cold + 20U * 8U);  // looking costs a little
    EXPECT_GE(nearer, 17);
}

TEST(ClosestFeatures, MoreBudgetIsNeverWorse) {
    const TwoBumpy scene(16);
    const TwoBumpy::Frame where = scene.at(0);
    ClosestQuery query(scene.a, scene.b);
    const ClosestResult full = query.find(where.stateA(), where.stateB());
    const float truth = full.pairs.at(0).signedDistance;
    float nearest = std::numeric_limits<float>::infinity();
    float proven = 0;
    std::size_t uncertain = 0;
    for (std::uint64_t work = 0; work <= full.work; work += 1 + work / 50) {
        const ClosestResult result = query.find(where.stateA(), where.stateB(), {}, {}, {.work = work});
        const float found = result.pairs.empty() ? nearest : result.pairs[0].signedDistance;
        EXPECT_LE(found, nearest);
        EXPECT_GE(result.atLeast, proven);
        EXPECT_LE(result.atLeast, truth);
        EXPECT_GE(found, truth);
        EXPECT_LE(result.work, work + 64);
        EXPECT_EQ(result.certain, result.stop == StopReason::certain);
        uncertain += result.certain ? 0 : 1;
        nearest = found;
        proven = result.atLeast;
    }
    EXPECT_GT(uncertain, 50U);
    EXPECT_GT(proven, 0.9F * truth);
}

TEST(ClosestFeatures, BeyondTheRangeThereIsNothing) {
    const PassingPair scene;
    ClosestQuery query(scene.a, scene.b);
    const Pose bInA{Eigen::Matrix3f::Identity(), {1.6F, 0, 0}};
    const ClosestResult all = query.find({}, rigidState(bInA));
    const float distance = all.pairs.at(0).signedDistance;
    const ClosestResult none = query.find({}, rigidState(bInA), {.maxDistance = 0.9F * distance});
    EXPECT_TRUE(none.certain);
    EXPECT_TRUE(none.pairs.empty());
    EXPECT_EQ(none.atLeast, 0.9F * distance);
    EXPECT_LT(none.work, all.work);
    const ClosestResult some = query.find({}, rigidState(bInA), {.maxDistance = 1.1F * distance});
    EXPECT_EQ(some.pairs.at(0).signedDistance, distance);
}

TEST(ClosestFeatures, AListHoldsTheNearestInTheirOrder) {
    const PassingPair scene(5);
    ClosestQuery query(scene.a, scene.b);
    Random random(12);
    for (int i = 0; i < 4; ++i) {
        const Pose bInA = closestBeside(0.1, random);
        std::vector<double> distances;
        for (std::uint32_t a = 0; a < scene.meshA.triangles.size(); ++a) {
            for (std::uint32_t b = 0; b < scene.meshB.triangles.size(); ++b) {
                distances.push_back(
                    triangleDistance(cornersOf(scene.meshA.view(), a), cornersOf(scene.meshB.view(), b, bInA)));
            }
        }
        std::ranges::sort(distances);
        const ClosestResult list = query.find({}, rigidState(bInA), {.maxDistance = 1, .most = 30});
        ASSERT_EQ(list.pairs.size(), 30U);
        for (std::size_t k = 0; k < 30; ++k) {
            EXPECT_NEAR(static_cast<double>(list.pairs[k].signedDistance), distances[k], 3e-6);
        }
        const ClosestResult spread = query.find({}, rigidState(bInA), {.maxDistance = 1, .most = 5, .spacing = 0.1F});
        ASSERT_GE(spread.pairs.size(), 2U);
        EXPECT_EQ(spread.pairs[0].signedDistance, list.pairs[0].signedDistance);
        for (std::size_t k = 0; k < spread.pairs.size(); ++k) {
            for (std::size_t l = 0; l < k; ++l) {
                EXPECT_GE(std::max((spread.pairs[k].onA - spread.pairs[l].onA).norm(),
                                   (spread.pairs[k].onB - spread.pairs[l].onB).norm()),
                          0.1F);
            }
        }
    }
}

TEST(ClosestFeatures, OfABodyWithItselfBeyondTheExclusion) {
    const Roll roll;
    const std::vector<Eigen::Vector3f> where = roll.at(3);
    const MeshView now{where, roll.mesh.triangles};
    const auto middle = [&](std::uint32_t t) {
        const Triangle& c = roll.mesh.triangles[t];
        return Eigen::Vector3f((roll.mesh.vertices[c[0]] + roll.mesh.vertices[c[1]] + roll.mesh.vertices[c[2]]) / 3);
    };
    const float exclusion = 0.5F;
    double truth = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < now.triangles.size(); ++i) {
        const Corners one = cornersOf(now, i);
        for (std::uint32_t j = i + 1; j < now.triangles.size(); ++j) {
            const Corners other = cornersOf(now, j);
            if ((middle(i) - middle(j)).norm() > exclusion && (one[0] - other[0]).norm() < truth + 0.3) {
                truth = std::min(truth, triangleDistance(one, other));
            }
        }
    }
    ClosestQuery query(roll.tree);
    for (const Stretch stretch : {Stretch::measured(), Stretch::refitted()}) {
        const ClosestResult result = query.find({where, {}, stretch, {}}, {.exclusion = exclusion});
        ASSERT_TRUE(result.certain);
        EXPECT_NEAR(static_cast<double>(result.pairs.at(0).signedDistance), truth, 2e-6);
        EXPECT_LT(result.pairs[0].pair.triangleA, result.pairs[0].pair.triangleB);
        const ClosestResult again =
            query.find({where, {}, stretch, {}}, {.exclusion = exclusion}, std::span(&result.pairs[0].pair, 1));
        EXPECT_EQ(again.pairs.at(0).signedDistance, result.pairs[0].signedDistance);
    }
}

TEST(ClosestFeatures, SameBytesOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    const TwoBumpy scene(12);
    std::vector<std::byte> first;
    for (const InstructionSet set : instructionSets()) {
        limitInstructionSet(set);
        ClosestQuery query(scene.a, scene.b);
        std::vector<std::byte> all;
        for (int frame = 0; frame < 6; ++frame) {
            const TwoBumpy::Frame where = scene.at(frame);
            for (const ClosestSettings& settings :
                 {ClosestSettings{}, ClosestSettings{.maxDistance = 0.3F, .most = 9, .spacing = 0.05F}}) {
                const std::vector<std::byte> one =
                    closestBytes(query.find(where.stateA(), where.stateB(), settings, {}, {.work = 200}));
                all.insert(all.end(), one.begin(), one.end());
            }
        }
        first = first.empty() ? all : first;
        EXPECT_EQ(all, first);
    }
    EXPECT_GT(first.size(), 500U);
}

TEST(ClosestFeatures, OddInputIsNamed) {
    const PassingPair scene(4);
    ClosestQuery query(scene.a, scene.b);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto fault = [&](const SurfaceState& a, const ClosestSettings& settings = {}) {
        const ClosestResult result = query.find(a, rigidState({Eigen::Matrix3f::Identity(), {3, 0, 0}}), settings);
        EXPECT_EQ(result.fault.has_value(), result.stop == StopReason::invalidInput);
        EXPECT_TRUE(!result.fault || (result.pairs.empty() && !result.certain));
        return result.fault;
    };
    EXPECT_EQ(fault({}), std::nullopt);
    EXPECT_EQ(fault({}, {.maxDistance = nan}), Fault::badSetting);
    EXPECT_EQ(fault({}, {.maxDistance = -1}), Fault::badSetting);
    EXPECT_EQ(fault({}, {.most = 0}), Fault::badSetting);
    EXPECT_EQ(fault({}, {.most = 2}), Fault::badSetting);  // without a range
    EXPECT_EQ(fault({}, {.spacing = -1}), Fault::badSetting);
    EXPECT_EQ(fault({}, {.exclusion = nan}), Fault::badSetting);
    EXPECT_EQ(fault(rigidState({2 * Eigen::Matrix3f::Identity(), {0, 0, 0}})), Fault::notRigid);
    std::vector<Eigen::Vector3f> moved = scene.meshA.vertices;
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}), std::nullopt);
    moved[3][1] = nan;
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}), Fault::notFinite);
    moved.assign(moved.size(), Eigen::Vector3f::Constant(nan));
    EXPECT_EQ(fault({moved, {}, Stretch::rigid(), {}}), Fault::notFinite);
    moved.pop_back();
    EXPECT_EQ(fault({moved, {}, Stretch::measured(), {}}), Fault::topologyChanged);
    std::vector<Triangle> others = scene.meshA.triangles;
    std::swap(others[0], others[1]);
    EXPECT_EQ(fault({{}, {}, Stretch::rigid(), others}), Fault::topologyChanged);

    const ClosestResult none =
        query.find({}, rigidState({Eigen::Matrix3f::Identity(), {3, 0, 0}}), {}, {}, {.work = 0});
    EXPECT_EQ(none.stop, StopReason::budget);
    EXPECT_TRUE(none.pairs.empty());
    EXPECT_EQ(none.atLeast, 0);
    EXPECT_EQ(none.work, 0U);
    const TrianglePair missing[] = {{1'000'000, 0}, {0, noTriangle}};
    EXPECT_TRUE(query.find({}, rigidState({Eigen::Matrix3f::Identity(), {3, 0, 0}}), {}, missing).certain);
}

}  // namespace
}  // namespace grapeshot::test
