// First impacts, against all pairs of triangles and the roots of their cubics; and against dense sampling where bodies
// turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <scf/continuous_scenes.hpp>
#include <support/oracle.hpp>
#include <support/test_size.hpp>

namespace grapeshot::test {
namespace {

std::vector<scenes::Mesh> shapes() {
    return {scenes::normalised(scenes::bumpySphere(1, 0.3F, 7, 3, 3), 1),
            scenes::normalised(scenes::torus(0.5F, 0.12F, 14, 6), 1), scenes::grid(0.4F, 0.3F, 6, 5),
            scenes::box({0.5F, 0.02F, 0.02F}, 1)};
}

/// Points of the triangles of the result at its time.
double distanceAtImpact(const MovingBody& a, const MovingBody& b, const Impact& impact) {
    const auto corners = [&](const MovingBody& body, std::uint32_t t) {
        Corners result;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = body.mesh.triangles[t][i];
            const Eigen::Vector3d before = body.before[v].cast<double>();
            result[i] = before + static_cast<double>(impact.time) * (body.now[v].cast<double>() - before);
        }
        return result;
    };
    return triangleDistance(corners(a, impact.pair.triangleA), corners(b, impact.pair.triangleB));
}

TEST(Impact, IsTheFirstOfAllPairsOfTriangles) {
    Random random(5);
    const std::vector<scenes::Mesh> meshes = shapes();
    int hits = 0;
    int clear = 0;
    const auto rounds = static_cast<int>(sampleSize(25, 200));
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (std::size_t j = 0; j < meshes.size(); ++j) {
            const BallTree a = buildBallTree(meshes[i].view());
            const BallTree b = buildBallTree(meshes[j].view());
            ImpactQuery query(a, b);
            for (int round = 0; round < rounds; ++round) {
                const MovingBody first = passingBody(meshes[i], 0.3, random);
                const MovingBody second = passingBody(meshes[j], random.uniform(0.4, 3), random);
                const double truth = meshImpact(first.exact(), second.exact());
                const ImpactResult result = query.find(first.motion(), second.motion(), {.tolerance = 1e-6F});
                ASSERT_TRUE(result.certain);
                EXPECT_EQ(result.stop, StopReason::certain);
                ASSERT_EQ(result.impact.has_value(), truth != noImpact) << round << " " << truth;
                if (!result.impact) {
                    EXPECT_EQ(result.freeUntil, 1);
                    ++clear;
                    continue;
                }
                ++hits;
                EXPECT_EQ(result.impact->time, result.freeUntil);
                EXPECT_LE(static_cast<double>(result.impact->time), truth + 1e-6);
                EXPECT_NEAR(static_cast<double>(result.impact->time), truth, 1e-3);
                if (truth > 0) {
                    EXPECT_LE(distanceAtImpact(first, second, *result.impact), 3e-6);
                    EXPECT_LE((result.impact->onA - result.impact->onB).norm(), 3e-6F);
                }
                EXPECT_NEAR(result.impact->normal.norm(), 1, 1e-5);
            }
        }
    }
    EXPECT_GT(hits, 4 * rounds);
    EXPECT_GT(clear, 4 * rounds);
}

TEST(Impact, OfTurningBodiesIsWhereTheirDistanceEnds) {
    Random random(8);
    const std::vector<scenes::Mesh> meshes = shapes();
    int hits = 0;
    int clear = 0;
    const int samples = 400;
    for (int round = 0; round < static_cast<int>(sampleSize(24, 200)); ++round) {
        const scenes::Mesh& meshA = meshes[static_cast<std::size_t>(round) % meshes.size()];
        const scenes::Mesh& meshB = meshes[static_cast<std::size_t>(round / 4) % meshes.size()];
        const BallTree a = buildBallTree(meshA.view());
        const BallTree b = buildBallTree(meshB.view());
        const auto turn = static_cast<float>(random.uniform(0, 7));
        const RigidMotion first{
            {random.rotation(), Eigen::Vector3f::Zero()}, 0.2F * random.direction(), turn * random.direction()};
        const RigidMotion second{{random.rotation(), static_cast<float>(random.uniform(0.3, 0.8)) * random.direction()},
                                 0.5F * random.direction(),
                                 3 * random.direction()};
        const ImpactResult result =
            ImpactQuery(a, b).find(rigidMotion(first), rigidMotion(second), {.tolerance = 1e-5F});
        ASSERT_TRUE(result.certain);
        double earliest = noImpact;
        for (int i = 0; i <= samples && earliest == noImpact; ++i) {
            const double time = static_cast<double>(i) / samples;
            const Pose poseA = poseAt(first, time);
            const Pose between = compose(inverse(poseA), poseAt(second, time));
            if (bruteForceDecide(meshA.view(), meshB.view(), between)) {
                earliest = time;
            }
        }
        hits += result.impact ? 1 : 0;
        clear += result.impact ? 0 : 1;
        if (!result.impact) {
            EXPECT_EQ(earliest, noImpact) << round;
            continue;
        }
        const auto time = static_cast<double>(result.impact->time);
        EXPECT_LE(time, earliest + 1e-6) << round;
        const double clearance = bruteForceClearance(meshA.view(), meshB.view(),
                                                     compose(inverse(poseAt(first, time)), poseAt(second, time)));
        EXPECT_LE(clearance, 1.5e-5) << round << " at " << time;
        if (time > 0) {
            EXPECT_GE(clearance, -1e-6) << round << " at " << time;  // not when they are in each other already
        }
    }
    EXPECT_GT(hits, 6);
    EXPECT_GT(clear, 2);
}

/// A strip that lies flat, and whose ends are folded so far up and over its middle. @param turn rad per half length
MovingBody foldedStrip(float turn) {
    const scenes::Mesh mesh = scenes::grid(1, 0.2F, 40, 6);
    MovingBody body{mesh, mesh.vertices, {}};
    for (const Eigen::Vector3f& v : mesh.vertices) {
        const float angle = turn * std::abs(v[0]);
        body.now.emplace_back(std::copysign(std::sin(angle) / 3.8F, v[0]), 0.3F - std::cos(angle) / 3.8F - 0.2F * v[0],
                              v[2]);
    }
    return body;
}

/// Of the pairs that count, by all pairs.
double selfImpact(const MovingBody& body, float exclusion) {
    const auto& triangles = body.mesh.triangles;
    const auto middle = [&](std::uint32_t t) {
        return Eigen::Vector3f((body.mesh.vertices[triangles[t][0]] + body.mesh.vertices[triangles[t][1]] +
                                body.mesh.vertices[triangles[t][2]]) /
                               3);
    };
    double first = noImpact;
    for (const TriangleImpact& impact : allImpacts(body.exact(), body.exact())) {
        const bool areNeighbours = std::ranges::find_first_of(triangles[impact.a], triangles[impact.b]) !=
                                   std::ranges::end(triangles[impact.a]);
        if (!areNeighbours && (middle(impact.a) - middle(impact.b)).norm() > exclusion) {
            first = std::min(first, impact.time);
        }
    }
    return first;
}

TEST(Impact, OfABodyWithItself) {
    Random random(4);
    int hits = 0;
    int clear = 0;
    for (const float turn : {0.5F, 0.8F, 1.0F, 1.2F, 1.5F}) {
        const MovingBody body = foldedStrip(turn * std::numbers::pi_v<float>);
        const BallTree tree = buildBallTree(body.mesh.view());
        ImpactQuery query(tree);
        for (const float exclusion : {0.0F, 0.3F}) {
            const ImpactSettings settings{.tolerance = 1e-6F, .exclusion = exclusion};
            const ImpactResult result = query.find(body.motion(Stretch::refitted()), settings);
            ASSERT_TRUE(result.certain);
            const double truth = selfImpact(body, exclusion);
            ASSERT_EQ(result.impact.has_value(), truth != noImpact) << turn << " " << exclusion << " " << truth;
            ++(result.impact ? hits : clear);

            // The frame that it stands in moves nothing against anything.
            SurfaceMotion moving = body.motion(Stretch::refitted());
            moving.frame = {{random.rotation(), random.direction()}, random.direction(), 4 * random.direction()};
            const ImpactResult turned = query.find(moving, settings);
            ASSERT_EQ(turned.impact.has_value(), result.impact.has_value());
            EXPECT_EQ(turned.freeUntil, result.freeUntil);
            if (!result.impact) {
                continue;
            }
            EXPECT_LE(static_cast<double>(result.impact->time), truth + 1e-6);
            EXPECT_NEAR(static_cast<double>(result.impact->time), truth, 1e-4);
            EXPECT_EQ(turned.impact->time, result.impact->time);
            const Pose pose = poseAt(moving.frame, static_cast<double>(turned.impact->time));
            EXPECT_LE((turned.impact->onA - apply(pose, result.impact->onA)).norm(), 1e-6F);
        }
    }
    EXPECT_GE(hits, 3);
    EXPECT_GE(clear, 3);
}

}  // namespace
}  // namespace grapeshot::test
