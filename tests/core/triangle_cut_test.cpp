#include <grapeshot/core/detail/triangle_cut.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/shapes.hpp"
#include "support/poses.hpp"

namespace grapeshot::detail {
namespace {

using Eigen::Vector3d;
using test::Random;

TriangleD randomTriangle(Random& random, double extent) {
    TriangleD triangle;
    for (Vector3d& corner : triangle) {
        corner =
            Vector3d(random.uniform(-extent, extent), random.uniform(-extent, extent), random.uniform(-extent, extent));
    }
    return triangle;
}

Vector3d normalOf(const TriangleD& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]);
}

/// Where the edges of `edges` pierce the face.
void pierce(const TriangleD& edges, const TriangleD& face, std::vector<Vector3d>& points) {
    const Vector3d normal = normalOf(face);
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector3d& from = edges[i];
        const Vector3d& to = edges[(i + 1) % 3];
        const double low = normal.dot(from - face[0]);
        const double high = normal.dot(to - face[0]);
        if ((low < 0) == (high < 0)) {
            continue;
        }
        const Vector3d point = from + low / (low - high) * (to - from);
        bool inside = true;
        for (std::size_t e = 0; e < 3; ++e) {
            inside = inside && normal.dot((face[(e + 1) % 3] - face[e]).cross(point - face[e])) >= 0;
        }
        if (inside) {
            points.push_back(point);
        }
    }
}

TEST(TriangleCut, IsTheSegmentBetweenTheTwoPiercings) {
    Random random(1);
    int cuts = 0;
    const int trials = 4000;
    for (int trial = 0; trial < trials; ++trial) {
        const TriangleD a = randomTriangle(random, 1);
        const TriangleD b = randomTriangle(random, 1);
        std::vector<Vector3d> points;
        pierce(a, b, points);
        pierce(b, a, points);
        const auto segment = cut(a, b);
        ASSERT_EQ(segment.has_value(), !points.empty());
        if (!segment) {
            continue;
        }
        ++cuts;
        ASSERT_EQ(points.size(), 2U);
        const bool straight = (segment->from - points[0]).norm() < (segment->to - points[0]).norm();
        EXPECT_LT((segment->from - points[straight ? 0 : 1]).norm(), 1e-9);
        EXPECT_LT((segment->to - points[straight ? 1 : 0]).norm(), 1e-9);
        EXPECT_GE(normalOf(a).cross(normalOf(b)).dot(segment->to - segment->from), 0);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ((segment->insideA >> i & 1U) != 0, normalOf(b).dot(a[i] - b[0]) < 0);
            EXPECT_EQ((segment->insideB >> i & 1U) != 0, normalOf(a).dot(b[i] - a[0]) < 0);
        }
        const auto swapped = cut(b, a);
        ASSERT_TRUE(swapped);
        EXPECT_LT((swapped->from - segment->to).norm() + (swapped->to - segment->from).norm(), 1e-9);
    }
    EXPECT_GT(cuts, trials / 20);
    EXPECT_LT(cuts, trials / 2);
}

TEST(TriangleCut, CoplanarTouchingAndDegenerateOnesHaveNone) {
    const TriangleD a = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    EXPECT_FALSE(cut(a, a));
    const TriangleD onTop = {Vector3d(0.2, 0.2, 0), Vector3d(0.2, 0.2, 1), Vector3d(0.3, 0.2, 1)};
    EXPECT_FALSE(cut(a, onTop)) << "a corner in the plane counts as outside";
    const TriangleD point = {Vector3d(0.2, 0.2, 0), Vector3d(0.2, 0.2, 0), Vector3d(0.2, 0.2, 0)};
    EXPECT_FALSE(cut(a, point));
    EXPECT_FALSE(cut(point, a));
    const TriangleD needle = {Vector3d(0.2, 0.2, -1), Vector3d(0.2, 0.2, 1), Vector3d(0.2, 0.2, 1)};
    EXPECT_FALSE(cut(a, needle));
}

TEST(TriangleCut, CurvesOfClosedMeshesCloseAndSpanTheCommonSection) {
    Random random(2);
    const auto ball = scenes::sphere(1, 6);
    const auto plate = scenes::box({2, 1, 2}, 7);
    for (int trial = 0; trial < 8; ++trial) {
        // The ball sinks into the plate's upper side, its middle `height` above.
        const double height = random.uniform(-0.7, 0.7);
        const Eigen::Matrix3d rotation = random.rotation().cast<double>();
        const Vector3d shift(random.uniform(-0.3, 0.3), 1 + height, random.uniform(-0.3, 0.3));
        Vector3d sum = Vector3d::Zero();
        Vector3d area = Vector3d::Zero();
        double length = 0;
        for (const Triangle& s : plate.triangles) {
            for (const Triangle& t : ball.triangles) {
                TriangleD a, b;
                for (std::size_t i = 0; i < 3; ++i) {
                    a[i] = plate.vertices[s[i]].cast<double>();
                    b[i] = rotation * ball.vertices[t[i]].cast<double>() + shift;
                }
                if (const auto segment = cut(a, b)) {
                    sum += segment->to - segment->from;
                    length += (segment->to - segment->from).norm();
                    area += 0.5 * segment->from.cross(segment->to);
                }
            }
        }
        const double section = std::numbers::pi * (1 - height * height);
        EXPECT_LT(sum.norm(), 1e-9);
        EXPECT_NEAR(area.y(), section, 0.04 * section) << "along the plate's outward normal";
        EXPECT_LT(std::hypot(area.x(), area.z()), 1e-9);
        EXPECT_NEAR(length, 2 * std::sqrt(std::numbers::pi * section), 0.04 * length);
    }
}

}  // namespace
}  // namespace grapeshot::detail
