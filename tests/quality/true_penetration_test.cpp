// The judge is judged: against formulas for spheres and boxes, and against brute force by winding numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>
#include <support/test_size.hpp>

namespace grapeshot::scenes {
namespace {

using Eigen::Vector3d;

/// splitmix64
class Draw {
  public:
    explicit Draw(std::uint64_t seed) : m_state(seed) {}
    double uniform(double low, double high) {
        m_state += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = m_state;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
        return low + (high - low) * static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
    }
    Vector3d in(const Vector3d& lower, const Vector3d& upper) {
        return {uniform(lower.x(), upper.x()), uniform(lower.y(), upper.y()), uniform(lower.z(), upper.z())};
    }
    Eigen::Matrix3d rotation() {
        const Vector3d axis = in(Vector3d::Constant(-1), Vector3d::Constant(1));
        return Eigen::AngleAxisd(uniform(-3, 3), axis.normalized()).toRotationMatrix();
    }

  private:
    std::uint64_t m_state;
};

Vector3d corner(const Mesh& mesh, const Triangle& t, std::size_t k) {
    return mesh.vertices[t[k]].cast<double>();
}

/// How often the surface winds round the point: the sum of solid angles (Van Oosterom, Strackee. 1983), over 4 pi.
double windingNumber(const Mesh& mesh, const Vector3d& p) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vector3d a = corner(mesh, t, 0) - p;
        const Vector3d b = corner(mesh, t, 1) - p;
        const Vector3d c = corner(mesh, t, 2) - p;
        sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                     b.dot(c) * a.norm() + c.dot(a) * b.norm());
    }
    return sum / (4 * std::numbers::pi);
}

double segmentDistance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm();
}

/// Plane distance where the foot is inside the triangle, else the nearest edge: another formula than the oracle's.
double bruteForceDistance(const Mesh& mesh, const Vector3d& p) {
    double best = 1e30;
    for (const Triangle& t : mesh.triangles) {
        const Vector3d a = corner(mesh, t, 0);
        const Vector3d b = corner(mesh, t, 1);
        const Vector3d c = corner(mesh, t, 2);
        const Vector3d n = (b - a).cross(c - a).normalized();
        const Vector3d foot = p - n * n.dot(p - a);
        const bool inside = n.dot((b - a).cross(foot - a)) >= 0 && n.dot((c - b).cross(foot - b)) >= 0 &&
                            n.dot((a - c).cross(foot - c)) >= 0;
        best = std::min(
            best, inside ? std::abs(n.dot(p - a))
                         : std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)}));
    }
    return best;
}

TEST(TrueSurface, AgreesWithBruteForceInDistanceAndSign) {
    Draw draw(1);
    const std::vector<Mesh> meshes{torus(1, 0.3F, 24, 12),          cup(0.5F, 0.05F, 1, 16, 5),
                                   spikedBall(0.3F, 0.3F, 12, 600), crossPlug(0.5F, 0.2F, 0.5F, 2),
                                   gear(0.5F, 0.1F, 0.1F, 0.2F, 9), torusKnot(2, 3, 1, 0.4F, 0.15F, 90, 8)};
    const std::size_t count = test::sampleSize(400, 10000);
    for (const Mesh& mesh : meshes) {
        const TrueSurface surface(mesh.view());
        ASSERT_TRUE(surface.closed());
        std::size_t inside = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Vector3d p = draw.in(surface.lower() * 1.1, surface.upper() * 1.1);
            const double distance = bruteForceDistance(mesh, p);
            const bool within = windingNumber(mesh, p) > 0.5;
            inside += within ? 1 : 0;
            EXPECT_NEAR(surface.signedDistance(p), within ? -distance : distance, 1e-9) << p.transpose();
        }
        EXPECT_GT(inside, count / 50) << "hardly a point inside: the sample says little about the sign";
        EXPECT_LT(inside, count * 9 / 10);
    }
}

TEST(TrueSurface, HasTheRightSignNextToVerticesAndEdges) {
    // Where plain face normals fail: points whose closest feature is a sharp vertex or edge.
    const Mesh mesh = spikedBall(0.3F, 0.6F, 12, 600);
    const TrueSurface surface(mesh.view());
    for (const Vector3d& sample : surface.samples()) {
        for (const double scale : {1 - 1e-4, 1 + 1e-4}) {
            const Vector3d p = sample * scale;
            EXPECT_EQ(surface.signedDistance(p) < 0, windingNumber(mesh, p) > 0.5) << p.transpose();
        }
    }
}

TEST(TrueSurface, DoesNotDependOnWeldingOrOrientation) {
    const Mesh mesh = torus(1, 0.3F, 16, 8);
    Mesh split;
    Mesh insideOut = mesh;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(split.vertices.size());
        for (const std::uint32_t v : t) {
            split.vertices.push_back(mesh.vertices[v]);
        }
        split.triangles.push_back({first, first + 1, first + 2});
    }
    for (Triangle& t : insideOut.triangles) {
        std::swap(t[0], t[1]);
    }
    const TrueSurface reference(mesh.view());
    const TrueSurface fromSplit(split.view());
    const TrueSurface fromInsideOut(insideOut.view());
    EXPECT_EQ(fromSplit.samples().size(), reference.samples().size());
    Draw draw(2);
    for (int i = 0; i < 200; ++i) {
        const Vector3d p = draw.in({-1.4, -0.4, -1.4}, {1.4, 0.4, 1.4});
        EXPECT_NEAR(fromSplit.signedDistance(p), reference.signedDistance(p), 1e-12);
        EXPECT_NEAR(fromInsideOut.signedDistance(p), reference.signedDistance(p), 1e-12);
    }
}

TEST(TrueSurface, SheetsHaveNoInside) {
    const TrueSurface sheet(grid(1, 1, 3, 3).view());
    EXPECT_FALSE(sheet.closed());
    EXPECT_NEAR(sheet.signedDistance({0.1, -0.5, 0.2}), 0.5, 1e-12);
    PoseD crossing;
    crossing.rotation = Eigen::AngleAxisd(1.0, Vector3d::UnitZ()).toRotationMatrix();
    EXPECT_EQ(truePenetration(sheet, crossing, sheet, {}), 0);
    // The sheet can still be inside a solid.
    EXPECT_NEAR(truePenetration(TrueSurface(sphere(0.5F, 12).view()), {}, TrueSurface(grid(1, 1, 4, 4).view()), {}),
                0.5, 5e-3);
}

TEST(TruePenetration, OfSpheresFollowsTheFormula) {
    const double r = 0.5;
    const TrueSurface ball(sphere(0.5F, 24).view());
    Draw draw(3);
    int deep = 0;
    for (int i = 0; i < 20; ++i) {
        const double distance = draw.uniform(0.5, 1.1);
        PoseD a{draw.rotation(), draw.in(Vector3d::Constant(-5), Vector3d::Constant(5))};
        PoseD b{draw.rotation(), a.translation + distance * (draw.rotation() * Vector3d::UnitX())};
        const double depth = std::max(0.0, 2 * r - distance);
        EXPECT_NEAR(truePenetration(ball, a, ball, b), depth, 4e-3) << "sagging of the facets, twice";
        deep += depth > 0 ? 1 : 0;
    }
    EXPECT_GT(deep, 10);
    EXPECT_LT(deep, 20);
}

TEST(TruePenetration, OfBoxesIsTheSameFromMeshAndFromFormula) {
    const Vector3d half(0.5, 0.3, 0.4);
    const TrueSurface mesh(box(half.cast<float>(), 4).view());
    const TrueSurface other(box({0.2F, 0.2F, 0.2F}, 3).view());
    Draw draw(4);
    int deep = 0;
    for (int i = 0; i < 100; ++i) {
        const PoseD fixed{draw.rotation(), draw.in(Vector3d::Constant(-5), Vector3d::Constant(5))};
        const PoseD moving{draw.rotation(),
                           fixed.translation + draw.in(Vector3d::Constant(-0.7), Vector3d::Constant(0.7))};
        const double byFormula = penetrationIntoBox(other, moving, half, fixed);
        EXPECT_GE(truePenetration(mesh, fixed, other, moving), byFormula - 1e-7) << "it also looks the other way round";
        EXPECT_EQ(truePenetration(mesh, fixed, other, moving), truePenetration(other, moving, mesh, fixed));
        deep += byFormula > 0.01 ? 1 : 0;
    }
    EXPECT_GT(deep, 20);
    EXPECT_LT(deep, 90);

    PoseD above;
    above.translation = {0.1, 0.3 + 0.2 - 0.05, 0.0};
    EXPECT_NEAR(penetrationIntoBox(other, above, half, {}), 0.05, 1e-6);
    EXPECT_NEAR(truePenetration(other, above, mesh, {}), 0.05, 1e-6);
}

TEST(TruePenetration, BelowAPlaneIsTheLowestSample) {
    const TrueSurface cube(box({0.5F, 0.5F, 0.5F}).view());
    PoseD pose;
    pose.rotation = Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitZ()).toRotationMatrix();
    pose.translation = {3, 1.2, -2};
    EXPECT_NEAR(penetrationBelowPlane(cube, pose, Vector3d::UnitY(), 1.0), std::sqrt(0.5) - 0.2, 1e-7);
    EXPECT_EQ(penetrationBelowPlane(cube, pose, Vector3d::UnitY(), 0.0), 0);
}

TEST(TruePenetration, NeverTakesANaNPoseForDeep) {
    const TrueSurface cube(box({0.5F, 0.5F, 0.5F}).view());
    PoseD broken;
    broken.translation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(truePenetration(cube, broken, cube, {}), 0);
    EXPECT_EQ(penetrationBelowPlane(cube, broken, Vector3d::UnitY(), 0), 0);
    EXPECT_EQ(penetrationIntoBox(cube, broken, Vector3d::Ones(), {}), 0);
}

}  // namespace
}  // namespace grapeshot::scenes
