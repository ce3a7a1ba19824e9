// The exact traversals of this room against the library and against the slow truth.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/reference/dop.hpp>
#include <grapeshot/adb/reference/exact_query.hpp>
#include <grapeshot/adb/reference/sphere.hpp>
#include <grapeshot/adb/reference/triangle_overlap.hpp>
#include <scenes/shapes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot::reference {
namespace {

using test::Random;
using test::sampleSize;

TEST(TriangleOverlap, AgreesWithTheOracle) {
    Random random(11);
    int overlapping = 0;
    const auto corner = [&](double scale) {
        Eigen::Vector3d point = scale * Eigen::Vector3d(random.unit(), random.unit(), random.unit());
        return point;
    };
    constexpr int pairs = 20'000;
    for (int i = 0; i < pairs; ++i) {
        test::Corners a{corner(1), corner(1), corner(1)};
        test::Corners b{corner(1), corner(1), corner(1)};
        if (i % 4 == 0) {  // coplanar, on a lattice: many touch in a point or an edge
            for (Eigen::Vector3d* point : {&a[0], &a[1], &a[2], &b[0], &b[1], &b[2]}) {
                *point = Eigen::Vector3d((8 * point->head<2>()).array().floor()(0),
                                         (8 * point->head<2>()).array().floor()(1), 0.5);
            }
        }
        const auto hasArea = [](const test::Corners& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm() > 0; };
        if (!hasArea(a) && !hasArea(b)) {
            continue;  // the oracle does not cross segments with segments
        }
        const bool truth = test::trianglesOverlap(a, b);
        EXPECT_EQ(trianglesOverlap(a, b), truth) << i;
        overlapping += truth ? 1 : 0;
    }
    EXPECT_GT(overlapping, pairs / 10);
    EXPECT_LT(overlapping, pairs * 9 / 10);
}

TEST(TriangleOverlap, DecidesSegmentsAndPoints) {
    const auto segment = [](double x0, double y0, double x1, double y1) {
        return test::Corners{Eigen::Vector3d(x0, y0, 1), Eigen::Vector3d(x1, y1, 1), Eigen::Vector3d(x0, y0, 1)};
    };
    const test::Corners along = segment(1, 4, 5, 4);
    EXPECT_TRUE(trianglesOverlap(along, segment(2, 2, 4, 5))) << "crossing";
    EXPECT_TRUE(trianglesOverlap(along, segment(5, 4, 7, 6))) << "end to end";
    EXPECT_TRUE(trianglesOverlap(along, segment(4, 4, 9, 4))) << "in one line";
    EXPECT_TRUE(trianglesOverlap(along, segment(3, 4, 3, 4))) << "a point on it";
    EXPECT_TRUE(trianglesOverlap(segment(3, 4, 3, 4), segment(3, 4, 3, 4)));
    EXPECT_FALSE(trianglesOverlap(along, segment(2, 2, 4, 3.9)));
    EXPECT_FALSE(trianglesOverlap(along, segment(6, 4, 9, 4)));
    EXPECT_FALSE(trianglesOverlap(along, segment(1, 5, 5, 5)));
    EXPECT_FALSE(trianglesOverlap(along, segment(3, 4.1, 3, 4.1)));
    EXPECT_FALSE(trianglesOverlap(segment(3, 4, 3, 4), segment(3, 5, 3, 5)));
}

template <class V>
class ExactQueries : public testing::Test {};
using Volumes = testing::Types<Box, Dop<18>, Dop<26>, Sphere>;
TYPED_TEST_SUITE(ExactQueries, Volumes);

TYPED_TEST(ExactQueries, AgreeWithTheLibraryAndTheOracle) {
    Random random(12);
    int poses = 0;
    int colliding = 0;
    int excused = 0;
    const std::vector<scenes::Mesh> meshes = {
        scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 4)), scenes::normalised(scenes::torus(1, 0.3F, 20, 8)),
        scenes::normalised(scenes::gear(1, 0.2F, 0.3F, 0.3F, 10)), scenes::normalised(scenes::box({1, 0.7F, 0.4F}, 2))};
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        const scenes::Mesh second = scenes::scaled(meshes[(m + 1) % meshes.size()], 0.7F);
        const Tree libraryA = build(meshes[m].view());
        const Tree libraryB = build(second.view());
        const auto a = bounded<TypeParam>(buildHierarchy(meshes[m].view(), m % 2 == 0 ? 1 : 3));
        const auto b = bounded<TypeParam>(buildHierarchy(second.view()));
        Query library(libraryA, libraryB);
        ExactQuery<TypeParam> exact(a, b);
        for (std::size_t i = 0; i < sampleSize(40, 500); ++i) {
            const Pose pose = test::randomPose(libraryA, libraryB, random);
            const ExactAnswer answer = exact.decide(pose);
            ++poses;
            colliding += answer.collides ? 1 : 0;
            EXPECT_LE(answer.collides, answer.rootsOverlap);
            const bool truth = test::bruteForceDecide(meshes[m].view(), second.view(), pose);
            if (answer.collides != truth || library.decide(pose).collides != truth) {
                ++excused;
                EXPECT_LT(std::abs(test::bruteForceClearance(meshes[m].view(), second.view(), pose)), 1e-5);
            }
        }
    }
    EXPECT_GT(colliding, poses / 5);
    EXPECT_LT(colliding, poses * 9 / 10);
    EXPECT_LE(excused, poses / 100);
}

TYPED_TEST(ExactQueries, AreRightWhereItIsClose) {
    const scenes::Mesh mesh = scenes::normalised(scenes::cup(1, 0.2F, 1.5F, 16, 4));
    const Tree library = build(mesh.view());
    const auto tree = bounded<TypeParam>(buildHierarchy(mesh.view()));
    ExactQuery<TypeParam> exact(tree, tree);
    int colliding = 0;
    int poses = 0;
    for (const double gap : {-1e-3, 1e-3}) {
        for (const Pose& pose : test::grazingPoses(library, library, static_cast<int>(sampleSize(25, 200)), gap, 13)) {
            const bool collides = exact.decide(pose).collides;
            EXPECT_EQ(collides, test::bruteForceDecide(mesh.view(), mesh.view(), pose));
            colliding += collides ? 1 : 0;
            ++poses;
        }
    }
    EXPECT_GT(colliding, poses / 4);
    EXPECT_LT(colliding, poses * 3 / 4);
}

TYPED_TEST(ExactQueries, EndAtTheFirstHit) {
    const scenes::Mesh mesh = scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 12));
    const auto tree = bounded<TypeParam>(buildHierarchy(mesh.view()));
    ExactQuery<TypeParam> exact(tree, tree);
    Pose deep;
    deep.translation = {0.4F, 0.1F, 0.2F};
    const ExactAnswer answer = exact.decide(deep);
    EXPECT_TRUE(answer.collides);
    EXPECT_LT(answer.volumeTests, 2000U);
    Pose far;
    far.translation = {9, 0, 0};
    EXPECT_EQ(exact.decide(far).volumeTests, 1U);
    EXPECT_FALSE(exact.decide(far).rootsOverlap);
}

}  // namespace
}  // namespace grapeshot::reference
