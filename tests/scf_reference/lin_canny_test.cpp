// Closest features of convex bodies against all pairs of triangles.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include <grapeshot/scf/reference/lin_canny.hpp>
#include <scenes/shapes.hpp>
#include <support/fault_of.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>
#include "hulls.hpp"

namespace grapeshot::scf::reference {
namespace {

using Eigen::Vector3d;
using test::Random;

/// The last one has the flattest faces and the sharpest corners.
const std::vector<scenes::Mesh>& meshes() {
    static const std::vector<scenes::Mesh> all{scenes::box({0.5F, 0.3F, 0.2F}),
                                               scenes::box({0.4F, 0.4F, 0.4F}, 3),
                                               scenes::sphere(0.5F, 4),
                                               test::prism(7, 0.3F, 0.6F),
                                               test::randomHull(24, {0.5F, 0.5F, 0.5F}, 11),
                                               test::randomHull(60, {0.6F, 0.4F, 0.3F}, 12),
                                               test::randomHull(30, {0.7F, 0.02F, 0.03F}, 13)};
    return all;
}

Pose near(Random& random, double low, double high) {
    const auto distance = static_cast<float>(random.uniform(low, high));
    return {random.rotation(), (distance * random.direction()).eval()};
}

bool inside(const scenes::Mesh& mesh, const Vector3d& point) {
    return std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
        const auto at = [&](std::size_t c) { return mesh.vertices[t[c]].cast<double>().eval(); };
        return (at(1) - at(0)).cross(at(2) - at(0)).dot(point - at(0)) <= 0;
    });
}

/// 0 if they share a point: surfaces that cross, or one body within the other.
double trueDistance(const scenes::Mesh& a, const scenes::Mesh& b, const Pose& bInA) {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < a.triangles.size(); ++i) {
        for (std::uint32_t j = 0; j < b.triangles.size(); ++j) {
            least = std::min(least,
                             test::triangleDistance(test::cornersOf(a.view(), i), test::cornersOf(b.view(), j, bInA)));
        }
    }
    const Eigen::Matrix3d rotation = bInA.rotation.cast<double>();
    const Vector3d translation = bInA.translation.cast<double>();
    const bool nested = inside(a, rotation * b.vertices[0].cast<double>() + translation) ||
                        inside(b, rotation.inverse() * (a.vertices[0].cast<double>() - translation));
    return nested ? 0 : least;
}

struct Case {
    std::size_t a, b;
    std::vector<Pose> poses;
};

/// Every pair of meshes, poses from deep inside each other to a body's length apart.
std::vector<Case> cases(std::size_t poses, std::uint64_t seed) {
    Random random(seed);
    std::vector<Case> result;
    for (std::size_t a = 0; a < meshes().size(); ++a) {
        for (std::size_t b = 0; b < meshes().size(); ++b) {
            Case one{a, b, {}};
            for (std::size_t i = 0; i < poses; ++i) {
                one.poses.push_back(near(random, 0, 1.6));
            }
            result.push_back(std::move(one));
        }
    }
    return result;
}

TEST(LinCanny, AgreesWithAllPairsColdAndWarm) {
    int separated = 0;
    int penetrating = 0;
    int stuck = 0;
    std::map<FeatureKind, int> kinds;
    for (const Case& one : cases(test::sampleSize(4, 60), 5)) {
        const ConvexPolyhedron a = convexPolyhedron(meshes()[one.a].view());
        const ConvexPolyhedron b = convexPolyhedron(meshes()[one.b].view());
        LinCanny warm(a, b);
        LinCanny cold(a, b, {.coherent = false});
        for (const Pose& pose : one.poses) {
            const double truth = trueDistance(meshes()[one.a], meshes()[one.b], pose);
            for (LinCanny* query : {&warm, &cold}) {
                const ClosestFeatures answer = query->closest(pose);
                ASSERT_NE(answer.outcome, Outcome::gaveUp) << one.a << " " << one.b;
                ASSERT_NEAR(answer.distance, truth, 1e-6) << one.a << " " << one.b;
                EXPECT_EQ(answer.outcome == Outcome::penetrating, answer.distance == 0);
                if (truth > 1e-6) {
                    ASSERT_EQ(answer.outcome, Outcome::closest);
                    EXPECT_NEAR((answer.onA - answer.onB).norm(), answer.distance, 1e-12);
                    ++kinds[answer.a.kind];
                }
                stuck += answer.stuck;
            }
            ++(truth > 0 ? separated : penetrating);
        }
    }
    EXPECT_GT(separated, 80);
    EXPECT_GT(penetrating, 40);
    EXPECT_GT(stuck, 5) << "the case of the stuck face did not occur";
    EXPECT_GT(kinds[FeatureKind::vertex], 20);
    EXPECT_GT(kinds[FeatureKind::edge], 20);
    EXPECT_GT(kinds[FeatureKind::face], 20);
}

TEST(LinCanny, StartsAnywhereAndEndsAtTheSameDistance) {
    Random random(77);
    const ConvexPolyhedron a = convexPolyhedron(meshes()[5].view());
    const ConvexPolyhedron b = convexPolyhedron(meshes()[3].view());
    for (int i = 0; i < 20; ++i) {
        const Pose pose = near(random, 0.2, 1.2);
        LinCanny query(a, b);
        const ClosestFeatures first = query.closest(pose);
        for (int start = 0; start < 60; ++start) {
            const auto some = [&random](const ConvexPolyhedron& body) {
                const auto kind = static_cast<FeatureKind>(random.bits() % 3);
                return Feature{kind, static_cast<std::uint32_t>(random.bits() % body.count(kind))};
            };
            query.startAt(some(a), some(b));
            const ClosestFeatures again = query.closest(pose);
            ASSERT_EQ(again.outcome, first.outcome);
            ASSERT_NEAR(again.distance, first.distance, 1e-9);
        }
    }
}

TEST(LinCanny, WitnessesLieOnTheirFeatures) {
    Random random(3);
    const ConvexPolyhedron a = convexPolyhedron(meshes()[4].view());
    LinCanny query(a, a);
    for (int i = 0; i < 100; ++i) {
        const Pose pose = near(random, 1.1, 2);
        const ClosestFeatures answer = query.closest(pose);
        ASSERT_EQ(answer.outcome, Outcome::closest);
        // Within the smallest box about the feature's corners.
        const auto expectOn = [](const ConvexPolyhedron& body, const Feature& feature, const Vector3d& point) {
            Vector3d lower = Vector3d::Constant(1e9);
            Vector3d upper = -lower;
            for (const std::uint32_t corner : body.cornersOf(feature)) {
                lower = lower.cwiseMin(body.vertices[corner]);
                upper = upper.cwiseMax(body.vertices[corner]);
            }
            EXPECT_TRUE((point.array() >= lower.array() - 1e-6).all() && (point.array() <= upper.array() + 1e-6).all());
        };
        expectOn(a, answer.a, answer.onA);
        expectOn(a, answer.b,
                 pose.rotation.cast<double>().transpose() * (answer.onB - pose.translation.cast<double>()));
    }
}

TEST(LinCanny, TakesFewerStepsFromTheLastFeatures) {
    // A tenth of a degree and a thousandth of the size per pose.
    const ConvexPolyhedron body = convexPolyhedron(scenes::sphere(0.5F, 12).view());
    LinCanny warm(body, body);
    LinCanny cold(body, body, {.coherent = false});
    int warmSteps = 0;
    int coldSteps = 0;
    for (int i = 0; i < 400; ++i) {
        const float angle = 0.0017F * static_cast<float>(i);
        const Eigen::Vector3f axis = Eigen::Vector3f(1, 2, 3).normalized();
        const Pose pose{Eigen::AngleAxisf(angle, axis).toRotationMatrix(),
                        {1.05F + 0.1F * std::cos(angle), 0.3F * std::sin(angle), 0.1F}};
        const ClosestFeatures fromLast = warm.closest(pose);
        const ClosestFeatures fromFirst = cold.closest(pose);
        ASSERT_NEAR(fromLast.distance, fromFirst.distance, 1e-9);
        if (i > 0) {
            warmSteps += fromLast.steps;
            coldSteps += fromFirst.steps;
        }
    }
    EXPECT_LT(warmSteps, 399 * 2);
    EXPECT_GT(coldSteps, 5 * warmSteps);
}

TEST(LinCanny, RecognisesPenetrationOfEveryKind) {
    const ConvexPolyhedron box = convexPolyhedron(scenes::box({1, 1, 1}).view());
    const ConvexPolyhedron small = convexPolyhedron(scenes::box({0.1F, 0.1F, 0.1F}).view());
    const ConvexPolyhedron needle = convexPolyhedron(scenes::box({3, 0.01F, 0.01F}).view());
    const auto outcome = [](const ConvexPolyhedron& a, const ConvexPolyhedron& b, const Eigen::Vector3f& at) {
        return LinCanny(a, b).closest({Eigen::Matrix3f::Identity(), at}).outcome;
    };
    EXPECT_EQ(outcome(box, small, {0.3F, 0.2F, 0.1F}), Outcome::penetrating) << "inside";
    EXPECT_EQ(outcome(small, box, {0.3F, 0.2F, 0.1F}), Outcome::penetrating) << "around";
    EXPECT_EQ(outcome(box, needle, {0.3F, 0.2F, 0.1F}), Outcome::penetrating) << "through, no vertex inside";
    EXPECT_EQ(outcome(box, box, {0, 0, 0}), Outcome::penetrating) << "the same place";
    EXPECT_EQ(outcome(box, box, {2, 0, 0}), Outcome::penetrating) << "faces touch";
    EXPECT_EQ(outcome(box, box, {2, 2, 2}), Outcome::penetrating) << "corners touch";
    EXPECT_EQ(outcome(box, box, {2.001F, 0.3F, 0}), Outcome::closest);
}

TEST(LinCanny, StepsAreBoundedAndTheEndIsNamed) {
    const ConvexPolyhedron body = convexPolyhedron(scenes::sphere(0.5F, 10).view());
    LinCanny query(body, body, {.mostSteps = 3});
    const ClosestFeatures answer = query.closest({Eigen::Matrix3f::Identity(), {-2, 1, 1}});
    EXPECT_EQ(answer.outcome, Outcome::gaveUp);
    EXPECT_EQ(answer.steps, 3);
    // What it has seen is where the next query goes on.
    ClosestFeatures next = answer;
    for (int i = 0; i < 100 && next.outcome == Outcome::gaveUp; ++i) {
        next = query.closest({Eigen::Matrix3f::Identity(), {-2, 1, 1}});
    }
    EXPECT_EQ(next.outcome, Outcome::closest);
}

TEST(ConvexPolyhedra, AreRefusedByName) {
    const auto reason = [](const scenes::Mesh& mesh) {
        try {
            static_cast<void>(convexPolyhedron(mesh.view()));
        } catch (const NotConvex& error) {
            EXPECT_NE(std::string(error.what()).find(name(error.reason())), std::string::npos);
            return std::optional(error.reason());
        }
        return std::optional<NotConvexReason>();
    };
    EXPECT_EQ(reason(scenes::box({1, 1, 1}, 2)), std::nullopt);
    EXPECT_EQ(reason(scenes::torus(1, 0.3F, 12, 8)), NotConvexReason::concave);
    EXPECT_EQ(reason(scenes::grid(1, 1, 2, 2)), NotConvexReason::open);
    EXPECT_EQ(reason(scenes::merged(scenes::box({1, 1, 1}), scenes::box({1, 1, 1}), {3, 0, 0})),
              NotConvexReason::severalPieces);
    scenes::Mesh insideOut = scenes::box({1, 1, 1});
    for (Triangle& t : insideOut.triangles) {
        std::swap(t[0], t[1]);
    }
    EXPECT_EQ(reason(insideOut), NotConvexReason::concave);
    scenes::Mesh flat = test::prism(5, 1, 1);
    for (Eigen::Vector3f& vertex : flat.vertices) {
        vertex.x() = 0;
    }
    EXPECT_EQ(reason(flat), NotConvexReason::flat);
    EXPECT_EQ(test::faultOf([] { static_cast<void>(convexPolyhedron({})); }), Fault::emptyMesh);
}

TEST(LinCanny, BadInputIsNamed) {
    const ConvexPolyhedron box = convexPolyhedron(scenes::box({1, 1, 1}).view());
    LinCanny query(box, box);
    Pose pose;
    pose.rotation *= 2;
    EXPECT_EQ(test::faultOf([&] { query.closest(pose); }), Fault::notRigid);
    pose.rotation(0, 0) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(test::faultOf([&] { query.closest(pose); }), Fault::notFinite);
    EXPECT_EQ(test::faultOf([&] { query.startAt({FeatureKind::face, 12}, {}); }), Fault::indexOutOfRange);
    EXPECT_EQ(test::faultOf([&] { query.startAt({}, {FeatureKind::vertex, 8}); }), Fault::indexOutOfRange);
    EXPECT_EQ(test::faultOf([&] { LinCanny(box, box, {.mostSteps = -1}); }), Fault::badSetting);
}

}  // namespace
}  // namespace grapeshot::scf::reference
