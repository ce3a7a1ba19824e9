// Depths against the slow truth, and what is done of meshes that are no solids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/scf/depth.hpp>

#include <adb/meshes.hpp>
#include <scf/depth_scenes.hpp>
#include <support/depth_oracle.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

TEST(Depth, OfEveryKindOfSolidIsTheOracles) {
    Random random(77);
    std::size_t regions = 0;
    std::size_t lost = 0;
    std::size_t shallow = 0;
    for (std::size_t i = 0; i < everyKind().size(); ++i) {
        const NamedMesh& one = everyKind()[i];
        const NamedMesh& other = everyKind()[(i + 1) % everyKind().size()];
        if (!inspect(one.mesh.view()).closed || !inspect(other.mesh.view()).closed) {
            continue;
        }
        SolidPair pair(one.mesh, other.mesh);
        pair.settings.spacing = i % 2 == 0 ? 0 : 0.1F;
        for (std::size_t pose = 0; pose < sampleSize(12, 60); ++pose) {
            const Pose bInA{random.rotation(), static_cast<float>(random.uniform(0.4, 1.1)) * random.direction()};
            const std::vector<TrackedContact> cuts = pair.cutsAt(bInA);
            const DepthResult result = pair.measure(bInA, cuts);
            ASSERT_TRUE(result.complete) << one.name;
            std::vector<char> isUsed(result.regions.size(), 0);
            for (const TrueRegion& truth : trueRegions(one.mesh.view(), other.mesh.view(), bInA, pairsOf(cuts))) {
                ++regions;
                const std::vector<std::size_t> found = regionsOf(result, truth);
                lost += found.empty() ? 1 : 0;
                double deepest = 0;
                for (const std::size_t index : found) {
                    isUsed[index] = 1;
                    if (result.regions[index].source != DepthSource::crossing) {
                        deepest = std::max(deepest, static_cast<double>(result.regions[index].depth));
                    }
                }
                EXPECT_LE(deepest, truth.depth * (1 + 1e-5) + 1e-6) << one.name << ' ' << other.name;
                shallow += truth.depth > 0.01 && deepest < 0.9 * truth.depth ? 1 : 0;
            }
            for (std::size_t index = 0; index < isUsed.size(); ++index) {
                EXPECT_TRUE(isUsed[index]) << one.name << ' ' << other.name << ": of no true region";
            }
        }
    }
    EXPECT_GT(regions, 150U);
    EXPECT_LE(static_cast<double>(lost), 0.02 * static_cast<double>(regions)) << lost;
    EXPECT_LE(static_cast<double>(shallow), 0.05 * static_cast<double>(regions)) << shallow;
}

TEST(Depth, TeethThatAreNearEachOtherAreRegionsOfTheirOwn) {
    const scenes::Mesh comb = scenes::comb(6, 1, 0.1F, 0.05F, 3);
    const scenes::Mesh block = scenes::box({2, 0.5F, 2}, 10);
    SolidPair pair(comb, block);
    // The teeth hang down into it, some centimetres apart.
    float lowest = 0;
    for (const Eigen::Vector3f& vertex : comb.vertices) {
        lowest = std::min(lowest, vertex[1]);
    }
    const Pose below{Eigen::Matrix3f::Identity(), {0.013F, lowest + 0.2F - 0.5F, 0.017F}};
    const std::vector<TrackedContact> cuts = pair.cutsAt(below);
    ASSERT_EQ(trueRegions(comb.view(), block.view(), below, pairsOf(cuts)).size(), 6U);
    pair.settings.spacing = 0;
    const DepthResult teeth = pair.measure(below, cuts);
    EXPECT_EQ(teeth.regions.size(), 6U);
    for (const DepthRegion& region : teeth.regions) {
        EXPECT_NEAR(region.depth, 0.2F, 1e-4F);
        EXPECT_GT(region.normal[1], 0.99F);
    }
    pair.settings.spacing = 0.3F;
    EXPECT_EQ(pair.measure(below, cuts).regions.size(), 1U);
}

TEST(Depth, BothOraclesAgree) {
    const scenes::Mesh knot = scenes::normalised(scenes::torusKnot(2, 3, 1, 0.5F, 0.2F, 40, 8));
    const scenes::Mesh bumpy = scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, 8, 4));
    SolidPair pair(knot, bumpy);
    Random random(9);
    std::size_t regions = 0;
    for (int pose = 0; pose < 10; ++pose) {
        const Pose bInA{random.rotation(), 0.8F * random.direction()};
        const std::vector<TrianglePair> cuts = pairsOf(pair.cutsAt(bInA));
        const std::vector<TrueRegion> slow = trueRegions(knot.view(), bumpy.view(), bInA, cuts);
        const std::vector<TrueRegion> fast = trueRegions(build(knot.view()), build(bumpy.view()), bInA, cuts);
        ASSERT_EQ(slow.size(), fast.size());
        for (std::size_t i = 0; i < slow.size(); ++i) {
            EXPECT_EQ(slow[i].insideA, fast[i].insideA);
            EXPECT_EQ(slow[i].insideB, fast[i].insideB);
            EXPECT_NEAR(slow[i].depth, fast[i].depth, 2e-6);
        }
        regions += slow.size();
    }
    EXPECT_GT(regions, 10U);
}

TEST(Depth, AlongItTheDeepestPointIsOut) {
    const scenes::Mesh bumpy = scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, 12, 4));
    SolidPair pair(bumpy, bumpy);
    Random random(4);
    int checked = 0;
    for (int pose = 0; pose < 40; ++pose) {
        const Pose bInA{random.rotation(), 1.0F * random.direction()};
        const DepthResult result = pair.measure(bInA, pair.cutsAt(bInA));
        for (const DepthRegion& region : result.regions) {
            EXPECT_NEAR(region.normal.norm(), 1, 1e-5);
            EXPECT_LT((region.onB - region.onA - region.depth * region.normal).norm(), 1e-5F);
            if (region.source == DepthSource::crossing) {
                continue;
            }
            ++checked;
            EXPECT_TRUE(region.isChecked);
            // Of that vertex it is the distance to the surface, and it is inside.
            const bool ofA = region.source == DepthSource::vertexOfA;
            std::vector<Eigen::Vector3d> surface;
            for (const Eigen::Vector3f& v : bumpy.vertices) {
                surface.push_back((ofA ? apply(bInA, v) : v).cast<double>());
            }
            const Eigen::Vector3d point = (ofA ? region.onA : region.onB).cast<double>();
            EXPECT_TRUE(isInside(surface, bumpy.triangles, point));
            EXPECT_NEAR(distanceTo(surface, bumpy.triangles, point), static_cast<double>(region.depth), 2e-6);
        }
    }
    EXPECT_GT(checked, 30);
}

TEST(Depth, OfABodyInsideAnotherIsTheShortestWayOut) {
    const scenes::Mesh outer = scenes::sphere(1, 8);
    const scenes::Mesh inner = scenes::merged(scenes::sphere(0.1F, 2), scenes::sphere(0.1F, 2), {0, 5, 0});
    SolidPair pair(outer, inner);
    const Pose inside{Eigen::Matrix3f::Identity(), {0.5F, 0, 0}};
    ASSERT_TRUE(pair.cutsAt(inside).empty());
    const DepthResult result = pair.measure(inside, {});
    ASSERT_EQ(result.regions.size(), 1U);
    EXPECT_EQ(result.regions[0].source, DepthSource::vertexOfB);
    EXPECT_EQ(result.regions[0].contacts, 0U);
    EXPECT_NEAR(result.regions[0].depth, 0.6F, 0.03F);  // its far end
    EXPECT_GT(std::abs(result.regions[0].normal[0]), 0.9F);
    EXPECT_LT(result.regions[0].normal[0], 0);  // A goes to -x, B to +x
    EXPECT_TRUE(pair.measure({Eigen::Matrix3f::Identity(), {3, 0, 0}}, {}).regions.empty());
    pair.settings.containment = false;
    EXPECT_TRUE(pair.measure(inside, {}).regions.empty());
}

TEST(Depth, OfEdgesThatCrossIsWhatPartsTheirTriangles) {
    const scenes::Mesh bar = scenes::box({1, 0.1F, 0.1F});
    SolidPair pair(bar, bar);
    // B lies across A, both on an edge.
    const Eigen::Matrix3f onEdge = Eigen::AngleAxisf(0.7853982F, Eigen::Vector3f::UnitX()).toRotationMatrix();
    const Eigen::Matrix3f across = Eigen::AngleAxisf(1.5707963F, Eigen::Vector3f::UnitY()).toRotationMatrix();
    const float side = 0.1F * std::sqrt(2.0F);
    pair.poseA = {onEdge, Eigen::Vector3f::Zero()};
    const Pose above{across * onEdge, {0.03F, 2 * side - 0.02F, 0.02F}};
    const DepthResult result = pair.measure(above, pair.cutsAt(above));
    ASSERT_EQ(result.regions.size(), 1U);
    EXPECT_EQ(result.regions[0].source, DepthSource::crossing);
    EXPECT_LT(result.regions[0].normal[1], -0.9F);  // A goes down
    EXPECT_GT(result.regions[0].depth, 0.005F);
    EXPECT_LE(result.regions[0].depth, 0.0201F);
}

TEST(Depth, NothingIsInsideAnOpenMesh) {
    const scenes::Mesh sheet = scenes::grid(1, 1, 12, 12);
    const scenes::Mesh ball = scenes::sphere(0.5F, 6);
    SolidPair pair(sheet, ball);
    const Pose through{Eigen::Matrix3f::Identity(), {0.03F, 0.2F, 0.05F}};
    const DepthResult result = pair.measure(through, pair.cutsAt(through));
    ASSERT_EQ(result.regions.size(), 1U);
    EXPECT_EQ(result.regions[0].source, DepthSource::vertexOfA);  // the sheet's, in the ball
    EXPECT_NEAR(result.regions[0].depth, 0.3F, 0.03F);
    SolidPair open(sheet, sheet);
    const Pose crossed{Eigen::AngleAxisf(1.2F, Eigen::Vector3f::UnitX()).toRotationMatrix(), {0.02F, 0.1F, 0.03F}};
    const std::vector<TrackedContact> cuts = open.cutsAt(crossed);
    ASSERT_FALSE(cuts.empty());
    for (const DepthRegion& region : open.measure(crossed, cuts).regions) {
        EXPECT_EQ(region.source, DepthSource::crossing);
    }
}

TEST(Depth, InsideOutOrSplitAlongSeamsItIsTheSameSolid) {
    const scenes::Mesh bumpy = scenes::normalised(scenes::bumpySphere(1, 0.25F, 5, 8, 4));
    scenes::Mesh reversed = bumpy;
    scenes::Mesh split;
    for (Triangle& t : reversed.triangles) {
        std::swap(t[1], t[2]);
    }
    for (const Triangle& t : bumpy.triangles) {
        const auto first = static_cast<std::uint32_t>(split.vertices.size());
        for (const std::uint32_t v : t) {
            split.vertices.push_back(bumpy.vertices[v]);
        }
        split.triangles.push_back({first, first + 1, first + 2});
    }
    const Pose bInA{Eigen::Matrix3f::Identity(), {0.9F, 0.1F, 0}};
    const auto depthsOf = [&](const scenes::Mesh& b) {
        SolidPair pair(bumpy, b);
        std::vector<float> depths;
        for (const DepthRegion& region : pair.measure(bInA, pair.cutsAt(bInA)).regions) {
            depths.push_back(region.depth);
        }
        std::ranges::sort(depths);
        return depths;
    };
    const std::vector<float> plain = depthsOf(bumpy);
    ASSERT_FALSE(plain.empty());
    for (const scenes::Mesh* other : {&reversed, &split}) {
        const std::vector<float> depths = depthsOf(*other);
        ASSERT_EQ(depths.size(), plain.size());
        for (std::size_t i = 0; i < plain.size(); ++i) {
            EXPECT_NEAR(depths[i], plain[i], 1e-5F);
        }
    }
}

}  // namespace
}  // namespace grapeshot::test
