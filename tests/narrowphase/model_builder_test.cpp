// Models built and moved in slices, and fetched so from a cache.
#include <grapeshot/narrowphase/model_builder.hpp>

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

#include <grapeshot/core/error.hpp>
#include <grapeshot/narrowphase/model_cache.hpp>
#include <scenes/shapes.hpp>
#include <support/same_bytes.hpp>
#include <support/slices.hpp>

namespace grapeshot {
namespace {

using test::inSlices;
using test::sameBytes;

void expectSame(const MeshModel& a, const MeshModel& b) {
    EXPECT_TRUE(sameBytes(a.tree.nodes, b.tree.nodes));
    EXPECT_TRUE(sameBytes(a.tree.leaves, b.tree.leaves));
    EXPECT_EQ(a.tree.vertices, b.tree.vertices);
    EXPECT_EQ(a.tree.stepRates, b.tree.stepRates);
    EXPECT_EQ(a.topology.welded, b.topology.welded);
    EXPECT_EQ(a.topology.across, b.topology.across);
    EXPECT_EQ(a.topology.ring, b.topology.ring);
    EXPECT_EQ(a.topology.closed, b.topology.closed);
    EXPECT_EQ(describe(a.report), describe(b.report));
    EXPECT_EQ(a.vertexNormals, b.vertexNormals);
    EXPECT_TRUE(sameBytes(a.vertexCones, b.vertexCones));
    EXPECT_EQ(a.triangleNormals, b.triangleNormals);
    EXPECT_EQ(a.traits, b.traits);
    EXPECT_EQ(a.vertexTriangle, b.vertexTriangle);
    EXPECT_EQ(a.leafOf, b.leafOf);
    EXPECT_EQ(a.solid, b.solid);
    ASSERT_EQ(a.leafShapes.size(), b.leafShapes.size());
    for (std::size_t i = 0; i < a.leafShapes.size(); ++i) {
        EXPECT_EQ(a.leafShapes[i].center, b.leafShapes[i].center);
        EXPECT_EQ(a.leafShapes[i].axis, b.leafShapes[i].axis);
        EXPECT_EQ(a.leafShapes[i].cosSpread, b.leafShapes[i].cosSpread);
        EXPECT_EQ(a.leafShapes[i].plain, b.leafShapes[i].plain);
    }
}

TEST(ModelBuilder, GivesTheBytesOfTheWhole) {
    for (const scenes::Mesh& mesh : {scenes::bumpySphere(1, 0.2F, 3, 16), scenes::grid(3, 3, 40, 40)}) {
        const MeshModel whole = makeModel(mesh.view());
        for (const std::uint64_t slice : {8U, 3000U}) {
            MeshModel model;
            model.tree = build(mesh.view(), {.tuningPoses = 0});
            EXPECT_LE(inSlices(makeModelInSlices(model), slice), 9 * mesh.triangles.size());
            expectSame(model, whole);
        }
    }
}

TEST(ModelBuilder, CopiesAndMoves) {
    scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 16);
    const MeshModel before = makeModel(mesh.view(), BuildSettings());
    ASSERT_NE(before.tree.stepRates, Tree().stepRates) << "tuned";
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.y() *= 0.5F;
    }
    MeshModel whole = before;
    refit(whole, mesh.vertices);
    MeshModel model;
    inSlices(copyInSlices(before, model), 8);
    expectSame(model, before);
    inSlices(refitInSlices(model, mesh.vertices), 8);
    expectSame(model, whole);
}

TEST(ModelBuilder, ACacheSharesWhatWasBuiltInSlices) {
    ModelCache cache;
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 16);
    const scenes::Mesh same = mesh;
    std::shared_ptr<const MeshModel> first;
    Sliced work = cache.getInSlices(mesh.view(), {.tuningPoses = 0}, first);
    work.run({.work = 1000});
    EXPECT_EQ(first, nullptr);
    std::shared_ptr<const MeshModel> meanwhile;
    inSlices(cache.getInSlices(same.view(), {.tuningPoses = 0}, meanwhile), 500);
    inSlices(std::move(work), 500);
    ASSERT_NE(first, nullptr);
    expectSame(*first, *meanwhile);
    EXPECT_EQ(cache.counts().builds, 2U) << "both were on their way";
    std::shared_ptr<const MeshModel> later;
    EXPECT_LT(inSlices(cache.getInSlices(same.view(), {.tuningPoses = 0}, later), 500), mesh.triangles.size());
    EXPECT_EQ(cache.get(same.view()), later);
    EXPECT_EQ(cache.counts().builds, 2U);
    EXPECT_EQ(cache.counts().hits, 2U);
    std::shared_ptr<const MeshModel> tuned;
    inSlices(cache.getInSlices(same.view(), {.tuningPoses = 64}, tuned), 500);
    EXPECT_NE(tuned, later) << "other settings, another model";
    EXPECT_EQ(cache.get(same.view(), {.tuningPoses = 64}), tuned);
    EXPECT_EQ(cache.counts().builds, 3U);
}

TEST(ModelBuilder, AFolderServesSlicesToo) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / ("grapeshot_slices_" + std::to_string(::getpid()));
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 16);
    for (const std::uint64_t loads : {0U, 1U}) {
        ModelCache cache;
        cache.setFolder(folder);
        std::shared_ptr<const MeshModel> model;
        inSlices(cache.getInSlices(mesh.view(), {.tuningPoses = 0}, model), 500);
        expectSame(*model, makeModel(mesh.view()));
        EXPECT_EQ(cache.counts().loads, loads);
        EXPECT_EQ(cache.counts().badFiles, 0U) << cache.lastWarning();
    }
    std::filesystem::remove_all(folder);
}

TEST(ModelBuilder, AnUnusableMeshLeavesTheCacheAsItWas) {
    ModelCache cache;
    scenes::Mesh mesh = scenes::grid(1, 1, 4, 4);
    mesh.triangles.front()[0] = 1000;
    std::shared_ptr<const MeshModel> model;
    EXPECT_THROW(inSlices(cache.getInSlices(mesh.view(), {.tuningPoses = 0}, model), 50), Error);
    EXPECT_EQ(model, nullptr);
    EXPECT_EQ(cache.counts().builds, 0U);
}

}  // namespace
}  // namespace grapeshot
