// Levels, the incomplete hierarchy, and the draws of new pairs.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <vector>

#include <grapeshot/scf/reference/detail/fan_distance.hpp>
#include <grapeshot/scf/reference/detail/pair_creation.hpp>
#include <grapeshot/scf/reference/detail/shallow_tree.hpp>
#include <grapeshot/scf/reference/surface.hpp>
#include <support/fault_of.hpp>
#include <support/oracle.hpp>
#include "bodies.hpp"

namespace grapeshot::scf::reference {
namespace {

using namespace detail;
using test::bodies;

TEST(Levels, PartTheFeaturesBelowThem) {
    const Surface& surface = bodies().a;
    ASSERT_GE(surface.levels.size(), 2U);
    EXPECT_EQ(surface.levels[0].centre.size(), bodies().mesh.vertices.size());
    for (std::size_t l = 1; l < surface.levels.size(); ++l) {
        const Level& fine = surface.levels[l - 1];
        const Level& coarse = surface.levels[l];
        EXPECT_LT(coarse.centre.size(), fine.centre.size() / 2);
        std::multiset<std::uint32_t> children(coarse.children.items.begin(), coarse.children.items.end());
        EXPECT_EQ(children.size(), fine.centre.size());
        for (std::uint32_t f = 0; f < fine.centre.size(); ++f) {
            EXPECT_EQ(children.count(f), 1U);
            EXPECT_EQ(std::ranges::count(coarse.children[fine.parent[f]], f), 1);
            for (const std::uint32_t neighbour : fine.ring[f]) {  // neighbours below are one or neighbours above
                const std::uint32_t up = fine.parent[neighbour];
                EXPECT_TRUE(up == fine.parent[f] || std::ranges::count(coarse.ring[fine.parent[f]], up) == 1);
            }
        }
    }
    EXPECT_TRUE(surface.levels.back().parent.empty());
}

TEST(Levels, AreBallsThatHoldWhatIsBelow) {
    const PlacedSurface placed(bodies().a, bodies().atA, "body");
    for (std::size_t l = 0; l < bodies().a.levels.size(); ++l) {
        for (std::uint32_t t = 0; t < bodies().mesh.triangles.size(); ++t) {
            for (const std::uint32_t vertex : bodies().mesh.triangles[t]) {
                std::uint32_t feature = bodies().a.featureOf[vertex];
                for (std::size_t up = 0; up < l; ++up) {
                    feature = bodies().a.levels[up].parent[feature];
                }
                for (const Eigen::Vector3f& corner : placed.corners(t)) {
                    EXPECT_LE((corner - placed.at(l, feature)).norm(), placed.radius(l, feature) * 1.00001F);
                }
            }
        }
    }
}

TEST(ShallowTrees, HoldTheirTrianglesAndProposeEveryContact) {
    const std::vector<Eigen::Vector3f> atB = bodies().atB(1.0F);
    const PlacedSurface a(bodies().a, bodies().atA, "A");
    const PlacedSurface b(bodies().b, atB, "B");
    const auto truth =
        test::bruteForcePairs({bodies().atA, bodies().mesh.triangles}, {atB, bodies().mesh.triangles}, {}, 0.01);
    ASSERT_GT(truth.size(), 20U);
    std::size_t before = 0;
    for (const int depth : {0, 2, 4, 6, 16}) {
        std::size_t tests = 0;
        const auto regions =
            overlappingNodes(bodies().a.tree, a.boxes(), bodies().b.tree, b.boxes(), depth, 0.01F, tests);
        EXPECT_GE(tests, regions.size());
        EXPECT_GE(regions.size(), before);
        before = regions.size();
        for (const TrianglePair& pair : truth) {
            EXPECT_TRUE(std::ranges::any_of(regions, [&](const NodePair& nodes) {
                return std::ranges::count(trianglesBelow(bodies().a.tree, nodes.first), pair.triangleA) > 0 &&
                       std::ranges::count(trianglesBelow(bodies().b.tree, nodes.second), pair.triangleB) > 0;
            })) << depth;
        }
    }
    EXPECT_GT(before, 20U);
    // Far fewer than all pairs of leaves: that is what it is for.
    EXPECT_LT(before, 256U * 256U / 20);
}

TEST(ShallowTrees, ReachAsFarAsTheyAreTold) {
    const scenes::Mesh box = scenes::box({1, 1, 1}, 4);
    const Surface surface = buildSurface(box.view());
    const std::vector<Eigen::Vector3f> beside = test::placed(box, {2.05F, 0, 0});
    const PlacedSurface a(surface, box.vertices, "A");
    const PlacedSurface b(surface, beside, "B");
    std::size_t tests = 0;
    EXPECT_TRUE(overlappingNodes(surface.tree, a.boxes(), surface.tree, b.boxes(), 5, 0.04F, tests).empty());
    EXPECT_FALSE(overlappingNodes(surface.tree, a.boxes(), surface.tree, b.boxes(), 5, 0.06F, tests).empty());
    EXPECT_FALSE(overlappingNodes(surface.tree, b.boxes(), surface.tree, a.boxes(), 5, 0.06F, tests).empty());
}

TEST(Fans, AreAsFarApartAsTheirClosestTriangles) {
    const std::vector<Eigen::Vector3f> atB = bodies().atB(1.0F);
    const PlacedSurface a(bodies().a, bodies().atA, "A");
    const PlacedSurface b(bodies().b, atB, "B");
    const MeshView meshA{bodies().atA, bodies().mesh.triangles};
    const MeshView meshB{atB, bodies().mesh.triangles};
    const auto features = static_cast<std::uint32_t>(bodies().a.levels[0].centre.size());
    int near = 0;
    for (std::uint32_t featureA = 0; featureA < features; ++featureA) {
        for (std::uint32_t featureB = 0; featureB < features; ++featureB) {
            // Farther apart, many triangles share the closest corner.
            if ((a.at(0, featureA) - b.at(0, featureB)).norm() > 0.12F) {
                continue;
            }
            ++near;
            std::size_t pairs = 0;
            const FanDistance fan = fanDistance(a, featureA, b, featureB, pairs);
            const auto truth = [&](std::uint32_t s, std::uint32_t t) {
                return test::triangleDistance(test::cornersOf(meshA, s), test::cornersOf(meshB, t));
            };
            double least = 1e9;
            for (const std::uint32_t s : bodies().a.fan[featureA]) {
                for (const std::uint32_t t : bodies().b.fan[featureB]) {
                    least = std::min(least, truth(s, t));
                }
            }
            EXPECT_NEAR(fan.distance, least, 1e-5);
            EXPECT_NEAR(truth(fan.triangleA, fan.triangleB), least, 1e-5);
            EXPECT_EQ(pairs, bodies().a.fan[featureA].size() * bodies().b.fan[featureB].size());
        }
    }
    EXPECT_GT(near, 100);
}

TEST(NewPairs, OfTheHierarchyLieWhereBoxesOverlap) {
    const std::vector<Eigen::Vector3f> atB = bodies().atB(1.1F);
    const PlacedSurface a(bodies().a, bodies().atA, "A");
    const PlacedSurface b(bodies().b, atB, "B");
    Settings settings = withHierarchy();
    settings.newPairs = 400;
    settings.hierarchyDepth = 6;
    const auto meanDistance = [&](const Created& created) {
        double sum = 0;
        for (const FeaturePair& pair : created.pairs) {
            sum += (a.at(0, pair.a) - b.at(0, pair.b)).norm();
        }
        return sum / static_cast<double>(created.pairs.size());
    };
    const Created near = createPairs(a, b, {}, settings, {1, 0, 0});
    EXPECT_EQ(near.pairs.size(), 400U);
    EXPECT_GT(near.regions, 10U);
    settings.tries = 32;
    const Created within = createPairs(a, b, {}, settings, {1, 0, 0});
    const Created anywhere = createPairs(a, b, {},
                                         [] {
                                             Settings s = withoutHierarchy();
                                             s.newPairs = 400;
                                             return s;
                                         }(),
                                         {1, 0, 0});
    EXPECT_EQ(anywhere.boxTests, 0U);
    EXPECT_LT(3 * meanDistance(near), meanDistance(anywhere));
    EXPECT_LT(meanDistance(within), meanDistance(near));
    // Without an overlap there is nothing to propose, and pairs are drawn all the same.
    const std::vector<Eigen::Vector3f> away = bodies().atB(5);
    const Created none = createPairs(a, PlacedSurface(bodies().b, away, "B"), {}, settings, {1, 0, 0});
    EXPECT_EQ(none.regions, 0U);
    EXPECT_EQ(none.pairs.size(), 400U);
}

TEST(NewPairs, OfTheVelocityFaceTheMotion) {
    const std::vector<Eigen::Vector3f> before = bodies().atB(1.3F);
    const std::vector<Eigen::Vector3f> atB = bodies().atB(1.2F);
    const PlacedSurface a(bodies().a, bodies().atA, "A");
    const PlacedSurface b(bodies().b, atB, "B");
    Settings settings = withoutHierarchy();
    settings.newPairs = 300;
    const auto normalX = [](const PlacedSurface& placed, std::uint32_t feature) {
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        for (const std::uint32_t t : placed.surface().fan[feature]) {
            const auto corners = placed.corners(t);
            normal += (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        }
        return normal.x();
    };
    const auto facing = [&](const Created& created) {  // B moves along -x
        std::size_t count = 0;
        for (const FeaturePair& pair : created.pairs) {
            count += normalX(a, pair.a) > 0 ? 1 : 0;
            count += normalX(b, pair.b) < 0 ? 1 : 0;
        }
        return count;
    };
    const std::size_t uniform = facing(createPairs(a, b, {bodies().atA, before}, settings, {1, 0, 0}));
    EXPECT_GT(uniform, 220U);
    EXPECT_LT(uniform, 380U);
    settings.velocityShare = 1;
    EXPECT_EQ(facing(createPairs(a, b, {bodies().atA, before}, settings, {1, 0, 0})), 600U);
    // Nothing known of the motion, or nothing that moves: uniform.
    for (const Before& none : {Before{}, Before{bodies().atA, atB}}) {
        EXPECT_LT(facing(createPairs(a, b, none, settings, {1, 0, 0})), 380U);
    }
}

TEST(Surfaces, BadInputIsNamed) {
    EXPECT_EQ(test::faultOf([] { static_cast<void>(buildSurface({})); }), Fault::emptyMesh);
    scenes::Mesh box = scenes::box({1, 1, 1});
    EXPECT_EQ(test::faultOf([&] { static_cast<void>(buildSurface(box.view(), {.treeDepth = 17})); }),
              Fault::badSetting);
    EXPECT_EQ(test::faultOf([&] { static_cast<void>(buildSurface(box.view(), {.coarsest = 0})); }), Fault::badSetting);
    box.triangles[3][1] = 99;
    EXPECT_EQ(test::faultOf([&] { static_cast<void>(buildSurface(box.view())); }), Fault::indexOutOfRange);
}

}  // namespace
}  // namespace grapeshot::scf::reference
