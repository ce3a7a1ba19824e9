// Section 6.5 against Monte Carlo.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <grapeshot/adb/reference/intersection_volume.hpp>
#include <grapeshot/adb/reference/probability.hpp>
#include <support/poses.hpp>

namespace grapeshot::reference {
namespace {

using Eigen::Vector3d;
using test::Random;

constexpr int samples = 20'000;

/// Share of the first box (about the origin) that lies in a second one of the same half extents.
double sharedPart(const Vector3d& half, const Eigen::Matrix3d& rotation, const Vector3d& at, Random& random) {
    int inside = 0;
    for (int i = 0; i < samples; ++i) {
        const Vector3d point =
            half.cwiseProduct(Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        const Vector3d local = rotation.transpose() * (point - at);
        inside += (local.cwiseAbs().array() <= half.array()).all() ? 1 : 0;
    }
    return static_cast<double>(inside) / samples;
}

// For cubes only: other boxes at a distance along no axis exceed it by up to one per cent of their volume.
TEST(IntersectionVolume, IsAnUpperBoundForCubes) {
    Random random(1);
    const Vector3d half(0.5, 0.5, 0.5);
    for (int i = 0; i < 300; ++i) {
        const double distance = random.uniform(0, 1.75);
        const Eigen::Matrix3d rotation =
            i % 3 == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : random.rotation().cast<double>();
        const Vector3d at = distance * random.direction().cast<double>();
        EXPECT_LE(sharedPart(half, rotation, at, random), equalBoxesVolume({1, 1, 1}, distance) + 0.015);
    }
}

TEST(IntersectionVolume, IsExactForCubesMovedAlongFaceEdgeAndSpaceDiagonal) {
    for (const double distance : {0.1, 0.4, 0.7}) {
        const double along = distance;
        const double v1 = 1 - along;
        const double v2 = std::pow(1 - along / std::sqrt(2), 2);
        const double v3 = std::pow(1 - along / std::sqrt(3), 3);
        EXPECT_NEAR(equalBoxesVolume({1, 1, 1}, distance), std::max({v1, v2, v3}), 1e-12);
    }
    EXPECT_EQ(equalBoxesVolume({3, 2, 1}, 0), 6);
    EXPECT_EQ(equalBoxesVolume({3, 2, 1}, std::sqrt(14.0)), 0);
}

// The claim is the paper's. Here boxes stay aligned and move in any direction.
TEST(IntersectionVolume, IsExceededByBoxesThatAreNoCubes) {
    Random random(14);
    int exceeded = 0;
    double worst = 0;
    for (int i = 0; i < samples; ++i) {
        Vector3d sides(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
        std::sort(sides.begin(), sides.end(), std::greater<>());
        const Vector3d apart = sides.cwiseProduct(Vector3d(random.unit(), random.unit(), random.unit()));
        const double excess = ((sides - apart).prod() - equalBoxesVolume(sides, apart.norm())) / sides.prod();
        exceeded += excess > 1e-9 ? 1 : 0;
        worst = std::max(worst, excess);
    }
    EXPECT_GT(exceeded, samples / 200);
    EXPECT_GT(worst, 0.003);
    EXPECT_LT(worst, 0.015);
}

TEST(IntersectionVolume, OfBallsIsTheLens) {
    Random random(2);
    for (int i = 0; i < 60; ++i) {
        const double radiusA = random.uniform(0.3, 1);
        const double radiusB = random.uniform(0.3, 1);
        const double distance = random.uniform(0, 1.1 * (radiusA + radiusB));
        int inside = 0;
        for (int s = 0; s < samples; ++s) {
            const Vector3d point =
                radiusA * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            const bool both = point.norm() <= radiusA && (point - Vector3d(distance, 0, 0)).norm() <= radiusB;
            inside += both ? 1 : 0;
        }
        const double cube = std::pow(2 * radiusA, 3);
        EXPECT_NEAR(lensVolume(radiusA, radiusB, distance), cube * inside / samples, 0.015 * cube);
    }
}

TEST(IntersectionVolume, OfBallsHasItsLimits) {
    const double small = 4 * std::numbers::pi / 3 * 0.125;
    EXPECT_NEAR(lensVolume(1, 0.5, 0.2), small, 1e-12);
    EXPECT_NEAR(lensVolume(1, 0.5, 0.5 + 1e-9), small, 1e-6);
    EXPECT_EQ(lensVolume(1, 0.5, 1.5), 0);
    EXPECT_NEAR(lensVolume(1, 1, 0), 4 * std::numbers::pi / 3, 1e-12);
}

TEST(IntersectionVolume, TakesBallsWhereSizesDiffer) {
    const Extent large = extentOf({Vector3d::Zero(), Vector3d::Constant(4)});
    const Extent small = extentOf({Vector3d::Zero(), Vector3d::Constant(1)});
    const Extent similar = extentOf({Vector3d::Zero(), Vector3d::Constant(2.5)});
    EXPECT_EQ(intersectionVolume(large, small, 3.5), intersectionVolume(small, large, 3.5));
    EXPECT_NEAR(intersectionVolume(large, small, 3.9), lensVolume(large.radius, small.radius, 3.9), 1e-12);
    EXPECT_EQ(intersectionVolume(large, similar, 1), equalBoxesVolume(similar.sides, 1));
    EXPECT_EQ(intersectionVolume(large, small, 0), small.volume) << "not the ball, which is larger than the box";
}

TEST(IntersectionVolume, ThickensFlatBoxes) {
    const Box flat{{0, 0, 0.5}, {2, 1, 0.5}};
    const Box thick = thickened(flat);
    EXPECT_EQ(thick.center(), flat.center());
    EXPECT_NEAR(thick.sides().z(), thinnestSide * 2, 1e-15);
    EXPECT_EQ(thick.sides().head<2>(), flat.sides().head<2>());
}

TEST(SharedCells, AreAllCellsOfANodeWithinItself) {
    const Extent extent = extentOf({Vector3d::Zero(), Vector3d(2, 1, 3)});
    const FilledNode node{&extent, 13, 4};
    const SharedCells all = sharedCells(node, node, sharedVolume<Box>(extent, extent, 0));
    EXPECT_NEAR(all.s, 64, 1e-9);
    EXPECT_NEAR(all.sA, 13, 1e-9);
    EXPECT_NEAR(all.sB, 13, 1e-9);
    const Extent cube = extentOf({Vector3d::Zero(), Vector3d::Constant(2)});
    const FilledNode ball{&cube, 13, 4};
    EXPECT_NEAR(sharedCells(ball, ball, sharedVolume<Sphere>(cube, cube, 0)).s, 64, 1e-9);
}

TEST(SharedCells, ScaleTheDensityOfTheCoarserNode) {
    const Extent small = extentOf({Vector3d::Zero(), Vector3d::Constant(1)});
    const Extent large = extentOf({Vector3d::Zero(), Vector3d::Constant(2)});
    const SharedCells shared = sharedCells({&small, 32, 4}, {&large, 32, 4}, 0.5);
    EXPECT_NEAR(shared.s, 32, 1e-9);
    EXPECT_NEAR(shared.sA, 16, 1e-9);
    EXPECT_NEAR(shared.sB, 8, 1e-9) << "cells of half the side: a surface crosses half the share of them";
}

}  // namespace
}  // namespace grapeshot::reference
