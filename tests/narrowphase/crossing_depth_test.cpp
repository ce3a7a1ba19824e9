// How deep a region is, against surfaces of which that is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <grapeshot/narrowphase/crossing_regions.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<CrossingRegion> regionsOf(std::span<const CurvePiece> pieces, const RegionSettings& settings) {
    std::vector<CrossingRegion> regions;
    groupCrossing(pieces, 20, settings, defaultCalibration(), regions);
    return regions;
}

/// The circle in which two surfaces of revolution about z cross: A below, whose normal is up, and B above. Slopes: of
/// the surfaces at the circle, against the horizontal.
std::vector<CurvePiece> circle(double radius, double slopeA, double slopeB, const Vector3d& place, int count = 48) {
    std::vector<CurvePiece> pieces;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        const Vector3d outward(std::cos(angle), std::sin(angle), 0);
        const Vector3d normalA = (slopeA * outward + Vector3d::UnitZ()).normalized();
        const Vector3d normalB = (slopeB * outward - Vector3d::UnitZ()).normalized();
        CurvePiece& piece = pieces.emplace_back();
        piece.position = (place + radius * std::cos(std::numbers::pi / count) * outward).cast<float>();
        piece.direction = (normalB - normalA).cast<float>();
        piece.length = static_cast<float>(2 * radius * std::sin(std::numbers::pi / count));
        piece.extent = piece.length / std::sqrt(12.0F);
        piece.slope = static_cast<float>(std::sqrt((1 + normalA.dot(normalB)) / (1 - normalA.dot(normalB))));
        piece.pair = {static_cast<std::uint32_t>(i), 0};
    }
    return pieces;
}

TEST(CrossingDepth, OfParaboloidsIsExact) {
    for (const double curvature : {0.05, 0.5, 2.0}) {
        for (const double depth : {0.002, 0.02, 0.1}) {
            // z = depth / 2 - curvature r^2, and its mirror image.
            const double radius = std::sqrt(depth / 2 / curvature);
            const auto pieces = circle(radius, 2 * curvature * radius, 2 * curvature * radius, {0.3, -0.2, 0.1});
            const auto regions = regionsOf(pieces, {.spacing = 0.2F, .normalCone = 0.5F});
            ASSERT_EQ(regions.size(), 1U);
            EXPECT_NEAR(regions[0].depth, depth, 2e-3 * depth);
            EXPECT_LE((regions[0].position - Vector3f(0.3F, -0.2F, 0.1F)).norm(), 1e-5F);
            EXPECT_LE((regions[0].normal + Vector3f::UnitZ()).norm(), 1e-5F) << "A, below, is pushed down";
            EXPECT_NEAR(regions[0].length, 2 * std::numbers::pi * radius, 0.01 * radius);
            EXPECT_NEAR(regions[0].extent, radius, 2e-3 * radius);
            // With a plane, or one that is more curved: as near as half an angle's tangent is half its tangent.
            const double both = std::sqrt(depth / curvature);
            const auto onPlane = regionsOf(circle(both, 2 * curvature * both, 0, Vector3d::Zero()),
                                           {.spacing = 0.2F, .normalCone = 0.5F});
            ASSERT_EQ(onPlane.size(), 1U);
            const double slope = 2 * curvature * both;
            EXPECT_NEAR(onPlane[0].depth, depth, depth * (0.003 + slope * slope / 4));
            EXPECT_LE(onPlane[0].depth, 1.003 * depth);
        }
    }
}

TEST(CrossingDepth, OfBallsIsNear) {
    for (const double depth : {0.01, 0.05, 0.2, 0.4}) {  // of radius 1
        const double height = 1 - depth / 2;
        const double radius = std::sqrt(1 - height * height);
        const auto regions = regionsOf(circle(radius, radius / height, radius / height, Vector3d::Zero()),
                                       {.spacing = 0.3F, .normalCone = 0.5F});
        ASSERT_EQ(regions.size(), 1U);
        EXPECT_GE(regions[0].depth, 0.995 * depth);
        EXPECT_LE(regions[0].depth, depth * (1.005 + depth / 3));
    }
}

TEST(CrossingDepth, KeepsPrecisionFarFromTheOrigin) {
    const double depth = 0.02;
    const double radius = std::sqrt(depth);
    const auto near =
        regionsOf(circle(radius, radius, radius, Vector3d::Zero()), {.spacing = 0.2F, .normalCone = 0.5F});
    const auto far =
        regionsOf(circle(radius, radius, radius, {4096, -8192, 2048}), {.spacing = 0.2F, .normalCone = 0.5F});
    ASSERT_EQ(near.size(), 1U);
    ASSERT_EQ(far.size(), 1U);
    EXPECT_NEAR(far[0].depth, near[0].depth, 2e-3 * depth);
    EXPECT_NEAR(far[0].extent, near[0].extent, 2e-3 * radius);
    EXPECT_LE((far[0].position - Vector3f(4096, -8192, 2048)).norm(), 1e-3F);
}

}  // namespace
}  // namespace grapeshot
