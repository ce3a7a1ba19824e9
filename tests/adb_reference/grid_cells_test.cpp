// Well-filled cells: clipping, the threshold, and what the definition by the letter comes to.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include <grapeshot/adb/reference/dop.hpp>
#include <grapeshot/adb/reference/grid_cells.hpp>
#include <grapeshot/adb/reference/sphere.hpp>
#include <grapeshot/adb/reference/tree.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot::reference {
namespace {

using Eigen::Vector3d;
using test::Random;

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double areaOf(const std::array<Vector3d, 3>& t) {
    return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
}

GridAreas gridOver(const Hierarchy& hierarchy, const Box& box, int grid) {
    GridAreas areas(box, grid);
    for (const auto& triangle : hierarchy.triangles) {
        areas.add(triangle);
    }
    return areas;
}

TEST(MaxArea, IsTheDiagonalRectangle) {
    EXPECT_NEAR(maxArea({1, 1, 1}), std::sqrt(2), 1e-15);
    EXPECT_NEAR(maxArea({1, 3, 2}), 3 * std::sqrt(5), 1e-15);
    EXPECT_NEAR(maxArea({1, 2, 0}), 2, 1e-15);
}

TEST(GridCells, CutsAddUpToTheMesh) {
    for (const scenes::Mesh& mesh : {scenes::sphere(1, 5), scenes::box({1, 0.5F, 0.25F}, 4),
                                     scenes::torus(1, 0.3F, 24, 12), scenes::gear(1, 0.2F, 0.3F, 0.3F, 10)}) {
        const Hierarchy hierarchy = buildHierarchy(mesh.view());
        double area = 0;
        for (const auto& triangle : hierarchy.triangles) {
            area += areaOf(triangle);
        }
        const Box box = Box::around(cornersOf(hierarchy, hierarchy.nodes[0]));
        for (const int grid : {1, 2, 4, 7}) {
            // Also where faces lie in planes of the grid.
            EXPECT_NEAR(sum(gridOver(hierarchy, box, grid).areas()), area, 1e-9 * area) << grid;
        }
        // Inside a part of the box: finer cells hold the same area.
        const Box part{box.center() - 0.3 * box.sides(), box.center() + 0.55 * box.sides()};
        const double coarse = sum(gridOver(hierarchy, part, 1).areas());
        EXPECT_GT(coarse, 0);
        EXPECT_LT(coarse, area);
        EXPECT_NEAR(sum(gridOver(hierarchy, part, 6).areas()), coarse, 1e-9 * area);
    }
}

TEST(GridCells, PutAreaWhereItIs) {
    GridAreas areas({Vector3d::Zero(), Vector3d::Constant(2)}, 2);
    areas.add({Vector3d(0, 0, 0.5), Vector3d(2, 0, 0.5), Vector3d(0, 2, 0.5)});
    EXPECT_NEAR(areas.areas()[0], 1, 1e-12);
    EXPECT_NEAR(areas.areas()[1], 0.5, 1e-12);
    EXPECT_NEAR(areas.areas()[2], 0.5, 1e-12);
    EXPECT_NEAR(areas.areas()[3], 0, 1e-12);
    EXPECT_NEAR(sum(areas.areas()), 2, 1e-12);
    // In the plane between two layers: the upper one's alone. In the last plane: the last layer's.
    GridAreas between({Vector3d::Zero(), Vector3d::Constant(2)}, 2);
    between.add({Vector3d(0, 0, 1), Vector3d(2, 0, 1), Vector3d(0, 2, 1)});
    EXPECT_NEAR(sum(between.areas()), 2, 1e-12);
    GridAreas last({Vector3d::Zero(), Vector3d::Constant(2)}, 2);
    last.add({Vector3d(0, 0, 2), Vector3d(2, 0, 2), Vector3d(0, 2, 2)});
    EXPECT_NEAR(sum(last.areas()), 2, 1e-12);
}

TEST(GridCells, NeverHoldMoreOfOneTriangleThanMaxArea) {
    Random random(5);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vector3d sides(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1));
        const auto corner = [&] { return Vector3d(5 * random.direction().cast<double>() + 0.5 * sides); };
        GridAreas areas({Vector3d::Zero(), sides}, 1);
        areas.add({corner(), corner(), corner()});
        EXPECT_LE(areas.areas()[0], maxArea(sides) * (1 + 1e-12));
        largest = std::max(largest, areas.areas()[0] / maxArea(sides));
    }
    EXPECT_GT(largest, 0.8);
}

// The definition by the letter: MaxArea itself. One smooth sheet never fills a cell with it, so p = 0 everywhere and
// the answer to every question is "no collision". What the paper calls "suitably chosen" is what makes the method work.
TEST(GridCells, OfASmoothSphereAreNeverFilledByTheLetter) {
    const scenes::Mesh mesh = scenes::sphere(1, 24);
    const auto tree = bounded<Box>(buildHierarchy(mesh.view(), 4));
    for (const int grid : {4, 6, 8}) {
        const std::array taus{1.0, 0.95, 0.7, 0.5, 0.3};
        const std::vector<CellCounts> counts = countCells(tree, grid, taus);
        EXPECT_EQ(counts[0].wellFilled[0], 0) << grid;
        EXPECT_EQ(counts[1].wellFilled[0], 0) << grid;
        EXPECT_GT(counts[3].wellFilled[0], 40) << grid;
        for (std::size_t i = 1; i < counts.size(); ++i) {
            for (std::size_t node = 0; node < counts[i].wellFilled.size(); ++node) {
                EXPECT_GE(counts[i].wellFilled[node], counts[i - 1].wellFilled[node]);
            }
        }
    }
}

// 4^3, 6^3 and 8^3 cells over the box of a fine sphere; known numbers by symmetry of the cube.
TEST(GridCells, OfASphereAreKnown) {
    const Hierarchy hierarchy = buildHierarchy(scenes::sphere(1, 40).view(), 8);
    const Box box{Vector3d::Constant(-1), Vector3d::Constant(1)};
    const GridAreas four = gridOver(hierarchy, box, 4);
    EXPECT_EQ(four.wellFilled(1), 0);
    EXPECT_EQ(four.wellFilled(0.8), 0);
    EXPECT_EQ(four.wellFilled(0.7), 24);
    EXPECT_EQ(four.wellFilled(0.5), 48);
    const GridAreas eight = gridOver(hierarchy, box, 8);
    EXPECT_EQ(eight.wellFilled(1), 0);
    EXPECT_EQ(eight.wellFilled(0.8), 48);
}

// P(A) is all that touches the volume, not only what hangs below the node.
TEST(CellCounts, SeeTheTrianglesOfOtherSubtrees) {
    // Two sheets close together; a node holds (mostly) one of them, its thickened box both.
    const scenes::Mesh lower = scenes::grid(1, 1, 8, 8);
    const scenes::Mesh mesh = scenes::merged(lower, lower, {0, 0.001F, 0});
    const auto tree = bounded<Box>(buildHierarchy(mesh.view(), 1));
    const CellCounts counts = countCells(tree, {1, 1.5});
    int doubled = 0;
    for (std::size_t i = 0; i < tree.hierarchy.nodes.size(); ++i) {
        const TreeNode& node = tree.hierarchy.nodes[i];
        double own = 0;
        for (std::uint32_t t = node.begin; t < node.end; ++t) {
            own += areaOf(tree.hierarchy.triangles[t]);
        }
        doubled += counts.wellFilled[i] == 1 && own < 1.5 * maxArea(tree.extents[i].sides) ? 1 : 0;
    }
    EXPECT_GT(doubled, 10);
}

template <class V>
class CellCountsOfEveryVolume : public testing::Test {};
using Volumes = testing::Types<Box, Dop<18>, Dop<26>, Sphere>;
TYPED_TEST_SUITE(CellCountsOfEveryVolume, Volumes);

TYPED_TEST(CellCountsOfEveryVolume, AreWithinTheGrid) {
    const auto tree = bounded<TypeParam>(buildHierarchy(scenes::bumpySphere(1, 0.25F, 6, 5).view()));
    const CellCounts counts = countCells(tree, {3, 0.4});
    ASSERT_EQ(counts.wellFilled.size(), tree.hierarchy.nodes.size());
    int filled = 0;
    for (const int count : counts.wellFilled) {
        EXPECT_GE(count, 0);
        EXPECT_LE(count, 27);
        filled += count > 0 ? 1 : 0;
    }
    EXPECT_GT(filled, static_cast<int>(counts.wellFilled.size()) / 4);
}

}  // namespace
}  // namespace grapeshot::reference
