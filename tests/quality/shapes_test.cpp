// Every shape by formula is what the header says: closed, outward, welded, without slivers, and of the right volume.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <grapeshot/core/mesh_report.hpp>
#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>

namespace grapeshot::scenes {
namespace {

constexpr double pi = std::numbers::pi;

struct Case {
    std::string name;
    Mesh mesh;
    double volume = 0;  ///< m^3 by formula; 0: none known
    double tolerance = 1e-5;
    std::size_t pieces = 1;
};

std::vector<Case> closedShapes() {
    return {
        {"box", box({1, 2, 3}), 48},
        {"fine box", box({1, 2, 3}, 7), 48},
        {"sphere", sphere(0.5F, 30), 4.0 / 3 * pi * 0.125, 2e-3},
        {"icosahedron", sphere(1, 1), 2.5361507, 1e-5},
        {"torus", torus(1, 0.25F, 96, 48), 2 * pi * pi * 0.0625, 5e-3},
        {"ring", ring(0.5F, 0.1F, 12, 8)},
        {"cup", cup(0.5F, 0.1F, 1.0F, 96, 10), pi * (0.25 * 1.0 - 0.16 * 0.9), 2e-3},
        {"coarse cup", cup(0.5F, 0.1F, 1.0F, 3, 1)},
        {"chain shot", chainShot(0.5F, 0.1F, 96, 48), 2 * 2 * pi * pi * 0.5 * 0.01, 5e-3, 2},
        {"crenel block", crenelBlock({1.0F, 0.5F, 0.5F}, 3), 2.0 * 0.75 + 2.0 * 0.6 * 0.25},
        {"fine crenel block", crenelBlock({1.0F, 0.5F, 0.5F}, 3, 4), 2.0 * 0.75 + 2.0 * 0.6 * 0.25},
        {"block of one tooth", crenelBlock({1.0F, 0.5F, 0.5F}, 1), 2.0},
        {"arch block", archBlock({1.0F, 0.5F, 0.4F}, 0.6F, 64), (2 - 0.5 * pi * 0.36) * 0.8, 2e-3},
        {"fine arch block", archBlock({1.0F, 0.5F, 0.4F}, 0.6F, 16, 4), (2 - 0.5 * pi * 0.36) * 0.8, 2e-3},
        {"U", uBody(1.0F, 0.6F, 0.2F, 0.3F), (1.0 * 0.2 + 2 * 0.6 * 0.2) * 0.3},
        {"fine U", uBody(1.0F, 0.6F, 0.2F, 0.3F, 3), (1.0 * 0.2 + 2 * 0.6 * 0.2) * 0.3},
        {"cross plug", crossPlug(0.5F, 0.2F, 0.7F, 2), (0.2 * 1.0 * 2 - 0.04) * 0.7},
        {"plate with cross hole", plateWithCrossHole(1.0F, 0.2F, 0.5F, 0.2F, 0.0F, 2), (4.0 - 0.36) * 0.2},
        {"spiked ball", spikedBall(0.3F, 0.15F, 24, 5000)},
        {"spiked ball, coarse", spikedBall(0.3F, 0.15F, 40, 100)},
        {"bumpy sphere", bumpySphere(0.5F, 0.1F, 6, 16)},
        {"torus knot", torusKnot(2, 3, 1.0F, 0.4F, 0.12F, 200, 12)},
        {"plain torus as a knot", torusKnot(1, 1, 1.0F, 0.001F, 0.25F, 96, 48), 2 * pi * pi * 0.0625, 6e-3},
        {"gear", gear(0.5F, 0.1F, 0.1F, 0.2F, 12)},
        {"fine gear", gear(0.5F, 0.1F, 0.1F, 0.2F, 12, 3)},
        {"comb", comb(5, 0.4F, 0.2F, 0.1F), (9 * 0.1 * 0.1 + 5 * 0.1 * 0.4) * 0.1},
        {"rod", threadedRod({0.5F, 0, 0.3F}, 2, 96, 10), pi * 0.25 * 2, 1e-3},
        {"threaded rod", threadedRod({0.5F, 0.05F, 0.3F}, 1.5F, 48, 60), pi * (0.25 + 0.5 * 0.0025) * 1.5, 5e-3},
        {"nut", threadedNut({0.5F, 0.05F, 0.3F}, 0.02F, 1.5F, 0.6F, 48, 24),
         (std::sqrt(3.0) / 2 * 2.25 - pi * (0.52 * 0.52 + 0.5 * 0.0025)) * 0.6, 1e-2},
        {"voussoir", voussoir(1, 1.5F, 0.4F, 0.5F, 12), 0.5 * 0.4 * (2.25 - 1) * 0.5, 1e-3},
        {"fine comb", comb(5, 0.4F, 0.2F, 0.1F, 3), (9 * 0.1 * 0.1 + 5 * 0.1 * 0.4) * 0.1},
    };
}

TEST(Shapes, AreClosedOutwardWeldedAndWithoutSlivers) {
    for (const Case& shape : closedShapes()) {
        SCOPED_TRACE(shape.name);
        const MeshReport report = inspect(shape.mesh.view());
        EXPECT_TRUE(report.closed) << describe(report);
        EXPECT_GT(report.volume, 0);
        EXPECT_EQ(report.distinctVertices, shape.mesh.vertices.size());
        EXPECT_EQ(report.unusedVertices, 0U);
        EXPECT_EQ(report.degenerateTriangles, 0U);
        EXPECT_EQ(report.pieces, shape.pieces);
        EXPECT_TRUE(TrueSurface(shape.mesh.view()).closed()) << "the oracle disagrees with the report";
    }
}

TEST(Shapes, HaveTheVolumeOfTheFormula) {
    int checked = 0;
    for (const Case& shape : closedShapes()) {
        if (shape.volume > 0) {
            SCOPED_TRACE(shape.name);
            EXPECT_NEAR(inspect(shape.mesh.view()).volume / shape.volume, 1, shape.tolerance);
            ++checked;
        }
    }
    EXPECT_GE(checked, 15);
}

TEST(Shapes, HaveTheNumberOfTrianglesOfTheHeader) {
    EXPECT_EQ(box({1, 1, 1}, 5).triangles.size(), 6U * 5 * 5 * 2);
    EXPECT_EQ(sphere(1, 9).triangles.size(), 20U * 81);
    EXPECT_EQ(bumpySphere(1, 0.1F, 5, 9).triangles.size(), 20U * 81);
    EXPECT_EQ(torus(1, 0.2F, 30, 20).triangles.size(), 2U * 30 * 20);
    EXPECT_EQ(torusKnot(2, 3, 1, 0.4F, 0.1F, 90, 10).triangles.size(), 2U * 90 * 10);
    for (const int wanted : {2000, 5000, 20000}) {
        const auto got = static_cast<double>(spikedBall(0.3F, 0.15F, 24, wanted).triangles.size());
        EXPECT_NEAR(got / wanted, 1, 0.1) << wanted;
    }
}

TEST(Shapes, SpikesReachTheirLength) {
    for (const int triangles : {500, 5000}) {
        float reach = 0;
        int tips = 0;
        for (const Eigen::Vector3f& v : spikedBall(0.3F, 0.15F, 24, triangles).vertices) {
            reach = std::max(reach, v.norm());
            tips += v.norm() > 0.4499F ? 1 : 0;
        }
        EXPECT_NEAR(reach, 0.45F, 1e-6F);
        EXPECT_EQ(tips, 24);
    }
}

TEST(Shapes, GridIsAnOpenSheetFacingUp) {
    const Mesh sheet = grid(2, 3, 4, 5);
    const MeshReport report = inspect(sheet.view());
    EXPECT_FALSE(report.closed);
    EXPECT_EQ(report.boundaryEdges, 2U * (4 + 5));
    EXPECT_EQ(report.misorientedEdges, 0U);
    EXPECT_NEAR(report.area, 24, 1e-5);
    for (const Triangle& t : sheet.triangles) {
        const Eigen::Vector3f u = sheet.vertices[t[1]] - sheet.vertices[t[0]];
        const Eigen::Vector3f v = sheet.vertices[t[2]] - sheet.vertices[t[0]];
        EXPECT_GT(u.z() * v.x() - u.x() * v.z(), 0);
    }
}

TEST(Shapes, ThePlugFitsItsHole) {
    // Clearance all around: no sample of the plug is inside the plate, and moved by more than the clearance some are.
    const TrueSurface plate(plateWithCrossHole(1.0F, 0.2F, 0.5F, 0.2F, 0.01F, 2).view());
    const TrueSurface plug(crossPlug(0.5F, 0.2F, 0.7F, 2).view());
    EXPECT_EQ(truePenetration(plug, {}, plate, {}), 0);
    PoseD shifted;
    shifted.translation = {0.03, 0, 0};
    EXPECT_NEAR(truePenetration(plug, shifted, plate, {}), 0.02, 1e-6);
}

TEST(Shapes, TheNutHasItsClearanceOnTheRod) {
    const Thread thread{1, 0.16F, 1};
    const TrueSurface rod(threadedRod(thread, 4, 96, 96).view());
    const TrueSurface nut(threadedNut(thread, 0.1F, 3, 2, 96, 48).view());
    EXPECT_EQ(truePenetration(nut, {}, rod, {}), 0);
    // Along the axis it has some play, and is held beyond; turned by a quarter it has moved by a quarter of the pitch.
    PoseD moved;
    moved.translation = {0, 0.5, 0};
    EXPECT_GT(truePenetration(nut, moved, rod, {}), 0.1);
    moved.translation = {0, 0.25, 0};
    moved.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
    EXPECT_EQ(truePenetration(nut, moved, rod, {}), 0);
}

TEST(Shapes, TheRingsOfAChainShotAreLinkedWithoutTouching) {
    const Mesh one = ring(0.5F, 0.1F, 24, 12);
    const Mesh both = chainShot(0.5F, 0.1F, 24, 12);
    ASSERT_EQ(both.vertices.size(), 2 * one.vertices.size());
    const TrueSurface first(MeshView{both.vertices, std::span(both.triangles).first(one.triangles.size())});
    double nearest = 1;
    for (std::size_t v = one.vertices.size(); v < both.vertices.size(); ++v) {
        nearest = std::min(nearest, first.signedDistance(both.vertices[v].cast<double>()));
    }
    EXPECT_NEAR(nearest, 0.5 - 2 * 0.1, 0.02);
}

TEST(Shapes, NormalisedHasItsBoxCentredAndItsDiagonal) {
    const MeshReport report = inspect(normalised(moved(comb(3, 0.4F, 0.2F, 0.1F), {5, 6, 7}), 3).view());
    EXPECT_NEAR((report.upper - report.lower).norm(), 3, 1e-5);
    EXPECT_LT((report.upper + report.lower).norm(), 1e-5);
}

}  // namespace
}  // namespace grapeshot::scenes
