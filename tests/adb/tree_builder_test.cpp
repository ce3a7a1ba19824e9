#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/error.hpp>

#include <support/fault_of.hpp>
#include "meshes.hpp"
#include "trees.hpp"

namespace grapeshot::test {
namespace {

using ::testing::IsEmpty;

TEST(Build, IsSoundOnEveryKind) {
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        EXPECT_THAT(findings(tree), IsEmpty());
        EXPECT_EQ(tree.triangles.size(), kind.mesh.triangles.size());
    }
}

TEST(Build, IsSoundWithEverySetting) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 6);
    for (int leafTriangles = 1; leafTriangles <= 4; ++leafTriangles) {
        for (const int bins : {4, 7, 16, 64}) {
            const Tree tree = build(mesh.view(), {leafTriangles, bins});
            EXPECT_THAT(findings(tree), IsEmpty()) << leafTriangles << " " << bins;
            for (const LeafBlock& leaf : tree.leaves) {
                for (int lane = leafTriangles; lane < 4; ++lane) {
                    EXPECT_EQ(leaf.triangle[lane], noTriangle);
                }
            }
        }
    }
}

TEST(Build, SameBytesTwice) {
    for (const NamedMesh& kind : everyKind()) {
        const Tree first = build(kind.mesh.view());
        const Tree second = build(kind.mesh.view());
        EXPECT_TRUE(sameBytes(first.nodes, second.nodes)) << kind.name;
        EXPECT_TRUE(sameBytes(first.distributions, second.distributions)) << kind.name;
        EXPECT_TRUE(sameBytes(first.leaves, second.leaves)) << kind.name;
    }
}

TEST(Build, OneTriangle) {
    const scenes::Mesh mesh = copiesOfOne(1);
    const Tree tree = build(mesh.view());
    EXPECT_THAT(findings(tree), IsEmpty());
    EXPECT_EQ(tree.nodes.size(), 1U);
    EXPECT_EQ(tree.leaves.size(), 1U);
    EXPECT_NEAR(surfaceOf(tree.nodes[0], tree.distributions[0], 0).area, 0.5, 0.001);
    EXPECT_NEAR(tree.radius, 1, 1e-6);
}

TEST(Build, CopiesOfOneTriangleEndInHalves) {
    const scenes::Mesh mesh = copiesOfOne(100'000);
    const Tree tree = build(mesh.view());
    EXPECT_EQ(tree.leaves.size(), std::size_t{1} << 15U);  // halved until at most four are left
    EXPECT_LE(depthOf(tree), 10U);
    EXPECT_THAT(findings(tree), IsEmpty());
}

TEST(Build, GrowingDistancesDoNotGrowTheStack) {
    // Each triangle a million times farther out than the one before: bins cut off one at a time.
    scenes::Mesh mesh;
    for (int i = 0; i < 3000; ++i) {
        const float place = std::pow(2.0F, -120.0F + static_cast<float>(i % 160));
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), {{place, 0, 0}, {place, place, 0}, {place, 0, place}});
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const Tree tree = build(mesh.view());
    EXPECT_LE(depthOf(tree), 80U);
    EXPECT_THAT(findings(tree), IsEmpty());
}

TEST(Build, ZeroAreaTrianglesStay) {
    scenes::Mesh mesh = scenes::box({1, 1, 1}, 2);
    const std::size_t sound = mesh.triangles.size();
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({2, 2, 2});
    const Tree tree = build(mesh.view());
    EXPECT_EQ(tree.triangles.size(), sound + 2);
    EXPECT_THAT(findings(tree), IsEmpty());
}

TEST(Build, NeedlesFarAwayAndAllScales) {
    for (const float scale : {1e-6F, 1e-3F, 1.0F, 1e6F, 1e12F}) {
        EXPECT_THAT(findings(build(scenes::scaled(needles(500), scale).view())), IsEmpty()) << scale;
        EXPECT_THAT(findings(build(scenes::scaled(soup(500, 0.2F, 3), scale).view())), IsEmpty()) << scale;
    }
    EXPECT_THAT(findings(build(scenes::moved(scenes::sphere(1, 8), {1e6F, -1e6F, 1e6F}).view())), IsEmpty());
}

TEST(Build, NamesTheFault) {
    const scenes::Mesh good = scenes::box({1, 1, 1});
    EXPECT_EQ(faultOf([&] { (void)build({}); }), Fault::emptyMesh);
    for (const BuildSettings settings : {BuildSettings{0, 16}, BuildSettings{5, 16}, BuildSettings{-1, 16},
                                         BuildSettings{4, 3}, BuildSettings{4, 65}}) {
        EXPECT_EQ(faultOf([&] { (void)build(good.view(), settings); }), Fault::badSetting);
    }
    scenes::Mesh bad = good;
    bad.vertices[3][1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(faultOf([&] { (void)build(bad.view()); }), Fault::notFinite);
    bad = good;
    bad.vertices[3][1] = 2e15F;
    EXPECT_EQ(faultOf([&] { (void)build(bad.view()); }), Fault::tooLarge);
    bad = good;
    bad.triangles[1][2] = 1000;
    EXPECT_EQ(faultOf([&] { (void)build(bad.view()); }), Fault::indexOutOfRange);
    bad = good;
    for (Triangle& triangle : bad.triangles) {
        triangle = {0, 0, 0};
    }
    EXPECT_EQ(faultOf([&] { (void)build(bad.view()); }), Fault::noSurface);
}

/// Area, mean and covariance by another way: the integral over each triangle by the rule that is exact for quadratics
/// (the middles of the edges, weight one third each).
TEST(Moments, AddUpToTheIntegral) {
    for (const NamedMesh& kind : everyKind()) {
        SCOPED_TRACE(kind.name);
        const Tree tree = build(kind.mesh.view());
        const std::vector<detail::LeafRange> ranges = detail::leafRanges(tree);
        for (std::size_t i = 0; i < tree.nodes.size(); i += 7) {
            for (int slot = 0; slot < 4; ++slot) {
                const ChildRef child = tree.nodes[i].child[slot];
                if (child == noChild) {
                    EXPECT_EQ(surfaceOf(tree.nodes[i], tree.distributions[i], slot).area, 0);
                    continue;
                }
                const detail::LeafRange range =
                    isLeaf(child) ? detail::LeafRange{indexOf(child), indexOf(child) + 1} : ranges[child];
                double area = 0;
                Eigen::Vector3d first = Eigen::Vector3d::Zero();
                Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
                for (std::uint32_t leaf = range.begin; leaf < range.end; ++leaf) {
                    for (const std::uint32_t triangle : tree.leaves[leaf].triangle) {
                        if (triangle == noTriangle) {
                            continue;
                        }
                        Eigen::Vector3d corner[3];
                        for (std::size_t c = 0; c < 3; ++c) {
                            corner[c] = tree.vertices[tree.triangles[triangle][c]].cast<double>();
                        }
                        const Eigen::Vector3d u = corner[1] - corner[0];
                        const Eigen::Vector3d v = corner[2] - corner[0];
                        const double own = 0.5 * std::sqrt(std::max(0.0, u.dot(u) * v.dot(v) - u.dot(v) * u.dot(v)));
                        area += own;
                        for (int edge = 0; edge < 3; ++edge) {
                            const Eigen::Vector3d middle = 0.5 * (corner[edge] + corner[(edge + 1) % 3]);
                            first += own / 3 * middle;
                            second += own / 3 * middle * middle.transpose();
                        }
                    }
                }
                const Eigen::Vector3d mean = first / area;
                const Eigen::Matrix3d covariance = second / area - mean * mean.transpose();
                const ChildSurface stored = surfaceOf(tree.nodes[i], tree.distributions[i], slot);
                double size = 0;
                for (const auto& half : tree.nodes[i].half) {
                    size = std::max(size, double{half[slot]});
                }
                EXPECT_NEAR(stored.area, area, 0.002 * area);
                const Eigen::Matrix3d thick = covariance + 0.005 * covariance.trace() * Eigen::Matrix3d::Identity();
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_NEAR(stored.mean[axis], mean[axis], size / 250 + 1e-5);
                    for (int other = 0; other < 3; ++other) {
                        EXPECT_NEAR(stored.covariance(axis, other), thick(axis, other), 0.02 * size * size);
                    }
                }
            }
        }
    }
}

TEST(Findings, SayWhatIsWrong) {
    const Tree good = build(scenes::bumpySphere(1, 0.25F, 6, 4).view());
    ASSERT_THAT(findings(good), IsEmpty());
    const auto isFound = [&](const auto& damage) {
        Tree bad = good;
        damage(bad);
        return !findings(bad).empty();
    };
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes[0].half[1][2] *= 0.9F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes[3].slabHigh[0] -= 0.1F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes[3].normal[0][0] += 0.1F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.distributions[1].area[0] += 4; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.leaves[5].triangle[0] = tree.leaves[6].triangle[0]; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.leaves[5].corner[1][2][0] += 1e-6F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes[1].child[0] = 0; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes[1].child[0] = leafBit | 1000000U; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.radius *= 0.5F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.whole.mean[1] += 1e-3F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.whole.covariance[0][2] += 1e-3F; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.whole.unit *= 2; }));
    EXPECT_TRUE(isFound([](Tree& tree) { tree.nodes.clear(); }));
}

}  // namespace
}  // namespace grapeshot::test
