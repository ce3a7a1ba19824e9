// LB against Monte Carlo.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include <grapeshot/adb/reference/grid_cells.hpp>
#include <grapeshot/adb/reference/lower_bound.hpp>
#include <support/poses.hpp>

namespace grapeshot::reference {
namespace {

using Eigen::Vector3d;
using test::Random;

/// A random plane through a cube of side 2 about the origin: n . x = d, uniform among the planes that hit the ball
/// around it.
struct Plane {
    Vector3d normal;
    double distance;
};

Plane randomPlane(Random& random) {
    return {random.direction().cast<double>(), random.uniform(-std::sqrt(3), std::sqrt(3))};
}

/// Two large triangles cover the plane.
double sectionArea(const Plane& plane) {
    const Vector3d u = plane.normal.unitOrthogonal();
    const Vector3d v = plane.normal.cross(u);
    const Vector3d middle = plane.distance * plane.normal;
    GridAreas areas({Vector3d::Constant(-1), Vector3d::Constant(1)}, 1);
    areas.add({middle + 4 * u, middle - 4 * u + 8 * v, middle - 4 * u - 8 * v});
    return areas.areas()[0];
}

bool meetInCube(const Plane& a, const Plane& b) {
    const Vector3d direction = a.normal.cross(b.normal);
    // The point of the common line that is nearest to the origin, then the line against the cube's slabs.
    const Vector3d point =
        (a.distance * b.normal.cross(direction) + b.distance * direction.cross(a.normal)) / direction.squaredNorm();
    double low = -1e9;
    double high = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
        const double t1 = (-1 - point[axis]) / direction[axis];
        const double t2 = (1 - point[axis]) / direction[axis];
        low = std::max(low, std::min(t1, t2));
        high = std::min(high, std::max(t1, t2));
    }
    return low <= high;
}

TEST(PlanarBound, IsHowOftenWellFillingPlanesMeet) {
    Random random(6);
    const double full = maxArea(Vector3d::Constant(2));
    for (const double tau : {0.001, 0.5, 0.7}) {
        int pairs = 0;
        int meeting = 0;
        std::vector<Plane> filling;
        for (int i = 0; i < 20'000; ++i) {
            const Plane plane = randomPlane(random);
            if (sectionArea(plane) >= tau * full) {
                filling.push_back(plane);
            }
        }
        for (std::size_t i = 0; i + 1 < filling.size(); i += 2) {
            ++pairs;
            meeting += meetInCube(filling[i], filling[i + 1]) ? 1 : 0;
        }
        ASSERT_GT(pairs, 1000);
        EXPECT_NEAR(planarBound(tau), static_cast<double>(meeting) / pairs, 0.03) << tau;
    }
}

TEST(PlanarBound, GrowsUpToCertainty) {
    double before = 0;
    for (double tau = 0; tau < 1.3; tau += 0.01) {
        EXPECT_GE(planarBound(tau), before);
        before = planarBound(tau);
    }
    EXPECT_EQ(planarBound(1), 1);
}

TEST(CurvatureBound, FallsWithTheCone) {
    EXPECT_EQ(curvatureBound(0.5, 0), planarBound(0.5));
    EXPECT_LT(curvatureBound(0.5, 1), planarBound(0.5));
    EXPECT_NEAR(curvatureBound(0.5, 2), 0.56 * planarBound(0.5), 1e-12);
    EXPECT_EQ(curvatureBound(0.5, 3), curvatureBound(0.5, 2));
}

TEST(DepthBound, IsTheShareOfBothDepths) {
    EXPECT_EQ(depthBound(0, 0, 10, 12), 0);
    EXPECT_EQ(depthBound(5, 6, 10, 12), 0.5);
    EXPECT_EQ(depthBound(10, 12, 10, 12), 1);
    EXPECT_EQ(depthBound(0, 0, 0, 0), 1);
}

}  // namespace
}  // namespace grapeshot::reference
