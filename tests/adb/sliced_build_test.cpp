// Trees built and moved in slices: the same bytes as at once, however they are sliced.
#include <grapeshot/adb/tree_builder.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>
#include <support/slices.hpp>

#include "trees.hpp"

namespace grapeshot {
namespace {

using test::inSlices;
using test::sameBytes;

void expectSame(const Tree& a, const Tree& b) {
    EXPECT_TRUE(sameBytes(a.nodes, b.nodes));
    EXPECT_TRUE(sameBytes(a.distributions, b.distributions));
    EXPECT_TRUE(sameBytes(a.leaves, b.leaves));
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.lower, b.lower);
    EXPECT_EQ(a.upper, b.upper);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.stepRates, b.stepRates);
    EXPECT_EQ(std::memcmp(a.whole.mean, b.whole.mean, sizeof(a.whole.mean)), 0);
    EXPECT_EQ(std::memcmp(a.whole.covariance, b.whole.covariance, sizeof(a.whole.covariance)), 0);
    EXPECT_EQ(a.whole.unit, b.whole.unit);
}

/// Some with groups above and below what is split in one piece, triangles that no plane parts, and one of each.
std::vector<scenes::Mesh> meshes() {
    scenes::Mesh one;
    one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    one.triangles = {{0, 1, 2}};
    scenes::Mesh stack = one;  // four hundred times the same place
    for (int i = 1; i < 400; ++i) {
        stack.triangles.push_back({0, 1, 2});
    }
    return {scenes::bumpySphere(1, 0.2F, 3, 24), scenes::grid(3, 3, 60, 60), one, stack};
}

TEST(SlicedBuild, GivesTheBytesOfTheWhole) {
    const auto tuning = mostSlicedPiece * static_cast<std::uint64_t>(BuildSettings().tuningPoses);
    for (const scenes::Mesh& mesh : meshes()) {
        const Tree whole = build(mesh.view());
        std::uint64_t price = 0;
        for (const std::uint64_t slice : {8U, 100U, 5000U}) {
            Tree tree;
            Sliced work = buildInSlices(mesh.view(), {}, tree);
            const std::uint64_t spent = inSlices(work, slice);
            EXPECT_TRUE(price == 0 || spent == price) << "what it costs does not depend on the slices";
            price = spent;
            expectSame(tree, whole);
        }
        EXPECT_LE(price, 7 * mesh.triangles.size() + 200 + tuning) << mesh.triangles.size();
        EXPECT_GT(price, tuning);
    }
}

TEST(SlicedBuild, WithoutTuningThereIsNoneToPayFor) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 24);
    Tree tree;
    Sliced work = buildInSlices(mesh.view(), {.tuningPoses = 0}, tree);
    EXPECT_LE(inSlices(work, 100), 7 * mesh.triangles.size() + 200);
    expectSame(tree, build(mesh.view(), {.tuningPoses = 0}));
    EXPECT_EQ(tree.stepRates, Tree().stepRates);
    EXPECT_NE(build(mesh.view()).stepRates, Tree().stepRates);
}

TEST(SlicedBuild, RefitToo) {
    scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 24);
    const Tree before = build(mesh.view());
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.x() *= 1.5F;
    }
    Tree whole = before;
    refit(whole, mesh.vertices);
    for (const std::uint64_t slice : {8U, 1000U}) {
        Tree tree = before;
        Sliced work = refitInSlices(tree, mesh.vertices);
        inSlices(work, slice);
        expectSame(tree, whole);
    }
}

TEST(SlicedBuild, FaultsComeUpInTheSliceThatFindsThem) {
    scenes::Mesh mesh = scenes::grid(3, 3, 60, 60);
    mesh.vertices.back().z() = std::numeric_limits<float>::infinity();
    Tree tree;
    Sliced work = buildInSlices(mesh.view(), {}, tree);
    EXPECT_THROW(inSlices(work, 8), Error);
    EXPECT_TRUE(work.isDone());
    Sliced bad = buildInSlices(mesh.view(), {.bins = 1}, tree);
    EXPECT_THROW(bad.run({.work = 8}), Error);
    Sliced tuned = buildInSlices(mesh.view(), {.tuningPoses = -1}, tree);
    EXPECT_THROW(tuned.run({.work = 8}), Error);
}

}  // namespace
}  // namespace grapeshot
