#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/adb/point_query.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {
namespace {

Eigen::Vector3f pointAround(const Tree& tree, Random& random) {
    Eigen::Vector3f point;
    for (int axis = 0; axis < 3; ++axis) {
        // Off the plane of a flat mesh too: there distances are zero and rays run along the triangles.
        const double half = 0.5 * (double{tree.upper[axis]} - tree.lower[axis]) + 0.05 * double{tree.radius};
        point[axis] = static_cast<float>(random.uniform(tree.lower[axis] - half, tree.upper[axis] + half));
    }
    return point;
}

double distanceTo(const Tree& tree, std::uint32_t triangle, const Eigen::Vector3f& point) {
    const Eigen::Vector3d p = point.cast<double>();
    return triangleDistance(cornersOf(tree.mesh(), triangle), {p, p, p});
}

TEST(ClosestPoint, IsTheNearestOfAll) {
    Random random(1);
    int features[3] = {};
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        for (std::size_t i = 0; i < sampleSize(10, 300); ++i) {
            const Eigen::Vector3f query = pointAround(tree, random);
            double nearest = std::numeric_limits<double>::infinity();
            for (std::uint32_t t = 0; t < tree.triangles.size(); ++t) {
                nearest = std::min(nearest, distanceTo(tree, t, query));
            }
            const auto found = closestPoint(tree, query, std::numeric_limits<float>::infinity());
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->distance, nearest, 1e-6);
            EXPECT_NEAR((found->point - query).norm(), nearest, 1e-6);
            EXPECT_NEAR(distanceTo(tree, found->triangle, query), nearest, 1e-6);
            EXPECT_LE(distanceTo(tree, found->triangle, found->point), 1e-6);
            ++features[found->feature < 3 ? 0 : found->feature < 6 ? 1 : 2];
            const Corners corners = cornersOf(tree.mesh(), found->triangle);
            if (found->feature < 3) {
                EXPECT_LE((corners[found->feature] - found->point.cast<double>()).norm(), 1e-6);
            } else if (found->feature < 6) {
                const Eigen::Vector3d& from = corners[found->feature - 3U];
                const Eigen::Vector3d& to = corners[(found->feature - 2U) % 3U];
                const Eigen::Vector3d offset = found->point.cast<double>() - from;
                EXPECT_LE(offset.cross((to - from).normalized()).norm(), 1e-6);
            }
            EXPECT_TRUE(closestPoint(tree, query, found->distance * 1.0001F));
            EXPECT_FALSE(closestPoint(tree, query, found->distance * 0.9999F));
        }
    }
    EXPECT_GT(*std::min_element(features, features + 3), 5);  // corners, edges and faces all occur
}

TEST(ClosestPoint, TiesGoToTheLowestTriangle) {
    const Tree tree = build(scenes::box({1, 1, 1}, 2).view());
    const auto found = closestPoint(tree, {3, 3, 3}, 100);
    ASSERT_TRUE(found);
    std::uint32_t lowest = noTriangle;
    for (std::uint32_t t = 0; t < tree.triangles.size() && lowest == noTriangle; ++t) {
        for (const std::uint32_t corner : tree.triangles[t]) {
            if (tree.vertices[corner] == Eigen::Vector3f(1, 1, 1)) {
                lowest = t;
            }
        }
    }
    EXPECT_EQ(found->triangle, lowest);
}

TEST(ClosestPoint, OfDegenerateTriangles) {
    scenes::Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 5, 0}, {1, 5, 0}, {0, 6, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {1, 1, 1}};
    const Tree tree = build(mesh.view());
    const auto found = closestPoint(tree, {1.5F, 0, 1}, 10);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, 1, 1e-6);
    EXPECT_EQ(found->triangle, 0U);
}

TEST(ClosestPoint, NothingForBadInput) {
    const Tree tree = build(scenes::sphere(1, 3).view());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(closestPoint(tree, {nan, 0, 0}, 1));
    EXPECT_FALSE(closestPoint(tree, {0, 0, 0}, nan));
    EXPECT_FALSE(closestPoint(tree, {0, 0, 0}, -1));
    EXPECT_FALSE(closestPoint(Tree(), {0, 0, 0}, 1));
    EXPECT_FALSE(castRay(tree, {nan, 0, 0}, {1, 0, 0}, 1));
    EXPECT_FALSE(castRay(tree, {0, 0, 0}, {0, 0, 0}, 1));
    EXPECT_FALSE(castRay(tree, {0, 0, 0}, {1, 0, 0}, -1));
    EXPECT_FALSE(castRay(Tree(), {0, 0, 0}, {1, 0, 0}, 1));
    EXPECT_FALSE(contains(tree, {nan, 0, 0}));
    EXPECT_FALSE(contains(Tree(), {0, 0, 0}));
}

/// Where the line origin + t direction meets the triangle, by solving the three equations.
std::optional<double> crossing(const Corners& corners, const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& direction) {
    Eigen::Matrix3d system;
    system << corners[1] - corners[0], corners[2] - corners[0], -direction;
    const double determinant = system.col(0).dot(system.col(1).cross(system.col(2)));
    if (determinant == 0) {
        return std::nullopt;
    }
    const Eigen::Vector3d right = origin - corners[0];
    const double u = right.dot(system.col(1).cross(system.col(2))) / determinant;
    const double v = system.col(0).dot(right.cross(system.col(2))) / determinant;
    const double t = system.col(0).dot(system.col(1).cross(right)) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 ? std::optional(t) : std::nullopt;
}

TEST(CastRay, IsTheFirstOfAllCrossings) {
    Random random(2);
    int hits = 0;
    int rays = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        for (std::size_t i = 0; i < sampleSize(20, 500); ++i, ++rays) {
            const Eigen::Vector3f origin = pointAround(tree, random);
            const Eigen::Vector3f direction = (i % 2 == 0 ? Eigen::Vector3f(pointAround(tree, random) - origin)
                                                          : Eigen::Vector3f(3 * random.direction()));
            const float maxT = i % 3 == 0 ? 0.5F : 10.0F;
            double first = std::numeric_limits<double>::infinity();
            for (std::uint32_t t = 0; t < tree.triangles.size(); ++t) {
                const auto at = crossing(cornersOf(tree.mesh(), t), origin.cast<double>(), direction.cast<double>());
                if (at && *at >= 0 && *at <= maxT) {
                    first = std::min(first, *at);
                }
            }
            const auto hit = castRay(tree, origin, direction, maxT);
            ASSERT_EQ(hit.has_value(), std::isfinite(first));
            if (!hit) {
                continue;
            }
            ++hits;
            EXPECT_NEAR(hit->t, first, 1e-5);
            const Corners corners = cornersOf(tree.mesh(), hit->triangle);
            const double along = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(direction.cast<double>());
            EXPECT_EQ(hit->backFace, along > 0);
        }
    }
    EXPECT_GT(hits, rays / 5);
    EXPECT_LT(hits, rays);
}

TEST(CastRay, NothingSlipsBetweenTriangles) {
    // Towards corners and middles of edges of a closed surface, from inside.
    const Tree tree = build(scenes::sphere(1, 6).view());
    for (const Triangle& triangle : tree.triangles) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Eigen::Vector3f& from = tree.vertices[triangle[corner]];
            const Eigen::Vector3f& to = tree.vertices[triangle[(corner + 1) % 3]];
            for (const Eigen::Vector3f& target : {from, Eigen::Vector3f(0.5F * (from + to))}) {
                const auto hit = castRay(tree, Eigen::Vector3f::Zero(), target, 2);
                ASSERT_TRUE(hit);
                EXPECT_NEAR(hit->t, 1, 0.05);
                EXPECT_TRUE(hit->backFace);
            }
        }
    }
}

TEST(Contains, TheFormulasSay) {
    Random random(3);
    const Tree ball = build(scenes::sphere(1, 12).view());
    const Tree ring = build(scenes::torus(1, 0.3F, 64, 32).view());
    const Tree block = build(scenes::box({1, 0.5F, 0.25F}, 4).view());
    int inside = 0;
    const int count = static_cast<int>(sampleSize(2000, 50'000));
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3f p =
            1.3F * Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).cast<float>();
        // The triangles cut the corners of the round ones: leave a shell out.
        if (p.norm() < 0.98F || p.norm() > 1) {
            EXPECT_EQ(contains(ball, p), p.norm() < 1);
        }
        const float around = std::hypot(std::hypot(p.x(), p.z()) - 1, p.y());
        if (around < 0.29F || around > 0.3F) {
            EXPECT_EQ(contains(ring, p), around < 0.3F);
        }
        const bool inBlock = std::abs(p.x()) < 1 && std::abs(p.y()) < 0.5F && std::abs(p.z()) < 0.25F;
        EXPECT_EQ(contains(block, p), inBlock);
        inside += inBlock ? 1 : 0;
    }
    EXPECT_GT(inside, count / 100);
}

TEST(Contains, RaysThroughEdgesDoNoHarm) {
    // The middle of a symmetric mesh sees edges and corners in many directions.
    for (int frequency = 1; frequency < 8; ++frequency) {
        EXPECT_TRUE(contains(build(scenes::sphere(1, frequency).view()), Eigen::Vector3f::Zero()));
        EXPECT_TRUE(contains(build(scenes::box({1, 1, 1}, frequency).view()), Eigen::Vector3f::Zero()));
    }
}

TEST(LeavesInBox, AreThoseWhoseBoxesTouch) {
    Random random(4);
    std::size_t listed = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        for (std::size_t i = 0; i < sampleSize(20, 200); ++i) {
            const Eigen::Vector3f one = pointAround(tree, random);
            const Eigen::Vector3f other = pointAround(tree, random);
            const Eigen::Vector3f lower = one.cwiseMin(other);
            const Eigen::Vector3f upper = one.cwiseMax(other);
            std::vector<std::uint32_t> found = {noTriangle};
            leavesInBox(tree, lower, upper, found);
            ASSERT_EQ(found.front(), noTriangle);  // appended
            found.erase(found.begin());
            EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
            for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
                Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9F);
                Eigen::Vector3f high = -low;
                for (const auto& corner : tree.leaves[leaf].corner) {
                    for (int lane = 0; lane < 4; ++lane) {
                        const Eigen::Vector3f p(corner[0][lane], corner[1][lane], corner[2][lane]);
                        low = low.cwiseMin(p);
                        high = high.cwiseMax(p);
                    }
                }
                const bool touches = (low.array() <= upper.array()).all() && (high.array() >= lower.array()).all();
                const bool clear =
                    ((low.array() - 1e-5F) > upper.array()).any() || ((high.array() + 1e-5F) < lower.array()).any();
                const bool isFound = std::binary_search(found.begin(), found.end(), leaf);
                EXPECT_TRUE(isFound ? !clear : !touches);
            }
            listed += found.size();
        }
    }
    EXPECT_GT(listed, 1000U);
}

TEST(LeavesBelowPlane, HoldEveryCornerBelow) {
    Random random(5);
    std::size_t listed = 0;
    std::size_t all = 0;
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        for (std::size_t i = 0; i < sampleSize(20, 200); ++i) {
            const Eigen::Vector3f normal = random.direction();
            const float offset = normal.dot(pointAround(tree, random));
            std::vector<std::uint32_t> found;
            leavesBelowPlane(tree, normal, offset, found);
            EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
            for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
                bool below = false;
                for (const auto& corner : tree.leaves[leaf].corner) {
                    for (int lane = 0; lane < 4; ++lane) {
                        below = below ||
                                normal.dot(Eigen::Vector3f(corner[0][lane], corner[1][lane], corner[2][lane])) < offset;
                    }
                }
                EXPECT_TRUE(!below || std::binary_search(found.begin(), found.end(), leaf));
            }
            listed += found.size();
            all += tree.leaves.size();
        }
    }
    EXPECT_GT(listed, all / 5);
    EXPECT_LT(listed, all * 4 / 5);  // a list of everything would pass the rest
}

}  // namespace
}  // namespace grapeshot::test
