// The oracle of sides on surfaces whose answer is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <scenes/shapes.hpp>

#include "support/sheet_oracle.hpp"

namespace grapeshot::test {
namespace {

std::vector<Eigen::Vector3d> verticesOf(const scenes::Mesh& mesh) {
    std::vector<Eigen::Vector3d> vertices;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        vertices.push_back(v.cast<double>());
    }
    return vertices;
}

TEST(VerticalOracle, AFlatSheetIsCrossedOnceAlsoOnItsEdgesAndNodes) {
    const scenes::Mesh sheet = scenes::grid(1, 1, 7, 7);
    const std::vector<Eigen::Vector3d> vertices = verticesOf(sheet);
    const VerticalOracle oracle(vertices, sheet.triangles);
    std::vector<Eigen::Vector3d> asked;
    for (const Triangle& t : sheet.triangles) {
        asked.push_back((vertices[t[0]] + vertices[t[1]] + vertices[t[2]]) / 3);
        asked.push_back((vertices[t[0]] + vertices[t[1]]) / 2);
        asked.push_back(vertices[t[2]]);
    }
    int crossed = 0;
    for (const Eigen::Vector3d& place : asked) {
        if (std::max(std::abs(place.x()), std::abs(place.z())) > 0.99) {
            continue;
        }
        ++crossed;
        const Crossings below = oracle.at(place - Eigen::Vector3d(0, 0.5, 0));
        EXPECT_EQ(below.above, 1);
        EXPECT_EQ(below.below, 0);
        const Crossings above = oracle.at(place + Eigen::Vector3d(0, 0.5, 0));
        EXPECT_EQ(above.above, 0);
        EXPECT_EQ(above.below, 1);
    }
    EXPECT_GT(crossed, 200);
    EXPECT_EQ(oracle.at({1.5, -0.5, 0}).above, 0);
}

TEST(VerticalOracle, AClosedSurfaceIsOddInsideAndEvenOutside) {
    const scenes::Mesh ball = scenes::sphere(1, 6);
    const std::vector<Eigen::Vector3d> vertices = verticesOf(ball);
    const VerticalOracle oracle(vertices, ball.triangles);
    EXPECT_EQ(oracle.at({0.11, 0.2, 0.07}).above, 1);
    EXPECT_EQ(oracle.at({0.11, -2, 0.07}).above, 2);
    EXPECT_EQ(oracle.at({0.11, 2, 0.07}).below, 2);
    const std::vector<Eigen::Vector3d> points{{0.11, 0.2, 0.07}, {0.11, -2, 0.07}, {0.11, 2, 0.07}};
    EXPECT_EQ(pointsBelow(oracle, points), 1);
    EXPECT_EQ(pointsAbove(oracle, points), 1);
}

}  // namespace
}  // namespace grapeshot::test
