// Which regions are believed.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include <grapeshot/narrowphase/crossing_regions.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

CrossingRegion regionOf(float probability, bool proven) {
    CrossingRegion region;
    region.probability = probability;
    region.proven = proven;
    region.positionError = 0.1F;
    region.position = {1, 2, 3};
    return region;
}

TEST(TakeRegions, MostLikelyKeepsThoseOfAtLeastOneHalf) {
    std::vector<CrossingRegion> regions{regionOf(0.9F, false), regionOf(0.499F, false), regionOf(1, true),
                                        regionOf(0.5F, false), regionOf(1e-6F, false)};
    takeRegions(Answer::mostLikely, {1, 2, 3}, regions);
    ASSERT_EQ(regions.size(), 3U);
    EXPECT_EQ(regions[0].probability, 0.9F);
    EXPECT_TRUE(regions[1].proven);
    EXPECT_EQ(regions[2].probability, 0.5F);
    for (const CrossingRegion& region : regions) {
        EXPECT_EQ(region.position, Vector3f(1, 2, 3));
    }
    regions.clear();
    takeRegions(Answer::mostLikely, {}, regions);
    EXPECT_TRUE(regions.empty());
}

TEST(TakeRegions, SampleKeepsEachInTheShareOfItsProbability) {
    const std::vector<float> probabilities{0.05F, 0.3F, 0.5F, 0.3F, 0.97F};
    std::vector<int> kept(probabilities.size(), 0);
    int bothThirds = 0;
    constexpr int draws = 20'000;
    Vector3d sum = Vector3d::Zero();
    Vector3d squares = Vector3d::Zero();
    for (std::uint64_t step = 0; step < draws; ++step) {
        std::vector<CrossingRegion> regions;
        for (const float probability : probabilities) {
            regions.push_back(regionOf(probability, false));
            regions.back().length = static_cast<float>(regions.size());  // its name
        }
        regions.push_back(regionOf(1, true));
        const RandomKey key{5, pairKey(3, 8), step};
        takeRegions(Answer::sample, key, regions);
        ASSERT_FALSE(regions.empty());
        ASSERT_TRUE(regions.back().proven);
        ASSERT_EQ(regions.back().position, Vector3f(1, 2, 3));
        bool second = false;
        for (std::size_t r = 0; r + 1 < regions.size(); ++r) {
            const auto name = static_cast<std::size_t>(regions[r].length) - 1;
            ++kept[name];
            const Vector3d off = (regions[r].position - Vector3f(1, 2, 3)).cast<double>();
            if (name == 4) {
                sum += off;
                squares += off.cwiseAbs2();
            }
            second |= name == 1;
            bothThirds += name == 3 && second ? 1 : 0;
        }
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double p = probabilities[i];
        EXPECT_NEAR(kept[i], p * draws, 4 * std::sqrt(p * (1 - p) * draws));
    }
    EXPECT_NEAR(bothThirds, 0.09 * draws, 4 * std::sqrt(0.09 * 0.91 * draws)) << "drawn apart from each other";
    // The place, too, is drawn from what is left open: 0.1 over all three axes.
    const double deviation = 0.1 / std::sqrt(3.0);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sum[axis] / kept[4], 0, 4 * deviation / std::sqrt(kept[4]));
        EXPECT_NEAR(std::sqrt(squares[axis] / kept[4]), deviation, 0.03 * deviation);
    }
}

TEST(TakeRegions, ADrawBelongsToItsKeyAndItsRegion) {
    int different = 0;
    for (std::uint64_t step = 0; step < 300; ++step) {
        const RandomKey key{7, 11, step};
        const auto lastOf = [&](float first, float second) {
            std::vector<CrossingRegion> regions{regionOf(first, false), regionOf(second, false), regionOf(0.5F, false)};
            regions.back().length = 3;
            takeRegions(Answer::sample, key, regions);
            return regions.empty() || regions.back().length != 3 ? std::optional<Vector3f>() : regions.back().position;
        };
        const auto first = lastOf(1e-6F, 1e-6F);
        EXPECT_EQ(lastOf(1e-6F, 1e-6F), first);
        EXPECT_EQ(lastOf(0.999999F, 0.3F), first) << "whatever becomes of the others";
        std::vector<CrossingRegion> other{regionOf(0.5F, false), regionOf(0.5F, false)};
        other[0].length = 1;
        other[1].length = 2;
        takeRegions(Answer::sample, key, other);
        different += other.size() == 1 ? 1 : 0;
        // Once kept, kept for any larger probability, at the same place.
        if (first) {
            std::vector<CrossingRegion> again{regionOf(0.2F, false), regionOf(0.2F, false), regionOf(0.8F, false)};
            takeRegions(Answer::sample, key, again);
            ASSERT_FALSE(again.empty());
            EXPECT_EQ(again.back().position, *first);
        }
    }
    EXPECT_NEAR(different, 150, 4 * std::sqrt(75));
}

}  // namespace
}  // namespace grapeshot
