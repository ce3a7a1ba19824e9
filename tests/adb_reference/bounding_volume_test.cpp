// Every kind of volume encloses its points, and calls no touching pair disjoint.
#include <gtest/gtest.h>

#include <algorithm>

#include <grapeshot/adb/reference/box.hpp>
#include <grapeshot/adb/reference/dop.hpp>
#include <grapeshot/adb/reference/sphere.hpp>
#include <support/poses.hpp>

namespace grapeshot::reference {
namespace {

using Eigen::Vector3d;
using test::Random;

std::vector<Vector3d> cloud(Random& random) {
    std::vector<Vector3d> points;
    const Vector3d scale(random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1));
    const Eigen::Matrix3d turn = random.rotation().cast<double>();
    const Vector3d at = random.direction().cast<double>();
    points.reserve(6);
    for (int i = 0; i < 6; ++i) {
        points.emplace_back(turn * scale.cwiseProduct(random.direction().cast<double>()) + at);
    }
    return points;
}

template <class V>
class BoundingVolumes : public testing::Test {};
using Volumes = testing::Types<Box, Dop<18>, Dop<26>, Sphere>;
TYPED_TEST_SUITE(BoundingVolumes, Volumes);

TYPED_TEST(BoundingVolumes, NeverPartPointsThatCoincide) {
    Random random(7);
    int disjoint = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::vector<Vector3d> a = cloud(random);
        const std::vector<Vector3d> b = cloud(random);
        Pose pose{random.rotation(), (4 * random.unit() * random.direction()).eval()};
        if (i % 2 == 0) {
            // A random mixture of A's points and one of B's meet.
            const Vector3d onA = 0.3 * a[0] + 0.5 * a[1] + 0.2 * a[2];
            const Vector3d onB = 0.6 * b[0] + 0.1 * b[3] + 0.3 * b[4];
            pose.translation = (onA - pose.rotation.cast<double>() * onB).cast<float>();
        }
        TypeParam volumeA = TypeParam::around(a);
        TypeParam volumeB = TypeParam::around(b);
        volumeA.inflate(1e-6);  // the translation is rounded to single precision
        const bool apart = typename TypeParam::PairTest(Placement(pose)).disjoint(volumeA, volumeB);
        if (i % 2 == 0) {
            EXPECT_FALSE(apart);
        } else {
            disjoint += apart ? 1 : 0;
        }
    }
    EXPECT_GT(disjoint, 200);
    EXPECT_LT(disjoint, 1900);
}

TYPED_TEST(BoundingVolumes, HaveABoxAroundTheirPoints) {
    Random random(8);
    for (int i = 0; i < 200; ++i) {
        const std::vector<Vector3d> points = cloud(random);
        const Box box = TypeParam::around(points).box();
        for (const Vector3d& point : points) {
            EXPECT_GE((point - box.lower).minCoeff(), -1e-12);
            EXPECT_GE((box.upper - point).minCoeff(), -1e-12);
        }
    }
}

TEST(DopCone, GivesTheDirectionBack) {
    Random random(9);
    for (int i = 0; i < 2000; ++i) {
        const Vector3d direction =
            i < 13 ? dopDirections()[static_cast<std::size_t>(i)] : Vector3d(random.direction().cast<double>());
        for (const int k : {18, 26}) {
            const DopCone cone = dopCone(k, direction);
            Vector3d sum = Vector3d::Zero();
            double weights = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_LT(cone.axis[c], k / 2);
                sum += cone.weight[c] * dopDirections()[static_cast<std::size_t>(cone.axis[c])];
                weights += std::abs(cone.weight[c]);
            }
            EXPECT_LT((sum - direction).norm(), 1e-12);
            EXPECT_LT(weights, k == 18 ? 1.2248 : 1.13) << "the three surround it";
        }
    }
}

TEST(Dop, IsTighterWithMoreDirections) {
    Random random(10);
    int boxes = 0;
    int eighteen = 0;
    int twentySix = 0;
    for (int i = 0; i < 3000; ++i) {
        const std::vector<Vector3d> a = cloud(random);
        const std::vector<Vector3d> b = cloud(random);
        const Placement placement({random.rotation(), (1.5F * random.direction()).eval()});
        boxes += Box::PairTest(placement).disjoint(Box::around(a), Box::around(b)) ? 1 : 0;
        eighteen += Dop<18>::PairTest(placement).disjoint(Dop<18>::around(a), Dop<18>::around(b)) ? 1 : 0;
        twentySix += Dop<26>::PairTest(placement).disjoint(Dop<26>::around(a), Dop<26>::around(b)) ? 1 : 0;
    }
    EXPECT_GT(eighteen, boxes);
    EXPECT_GT(twentySix, eighteen);
}

}  // namespace
}  // namespace grapeshot::reference
