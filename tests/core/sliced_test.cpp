// Computations in slices: never more than they were given, the same result however it is sliced.
#include <grapeshot/core/detail/sliced_sort.hpp>
#include <grapeshot/core/mesh_slices.hpp>
#include <grapeshot/core/sliced.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include <grapeshot/core/error.hpp>
#include <scenes/shapes.hpp>
#include <support/poses.hpp>

namespace grapeshot {
namespace {

Sliced countUp(int pieces, std::uint64_t price, int& done) {
    for (int i = 0; i < pieces; ++i) {
        co_yield price;
        ++done;
    }
}

Sliced twice(int& done) {
    co_await countUp(3, 5, done);
    co_await countUp(2, 2, done);
}

Sliced manyParts(int parts, int& done) {
    for (int i = 0; i < parts; ++i) {
        co_await countUp(1, 1, done);
    }
}

Sliced failing(int& done) {
    co_await countUp(2, 3, done);
    throw std::runtime_error("on purpose");
}

Sliced catching(int& done, bool& caught) {
    try {
        co_await failing(done);
    } catch (const std::runtime_error&) {
        caught = true;
    }
    co_await countUp(1, 1, done);
}

TEST(Sliced, DoesNothingBeforeItIsRunAndNoMoreThanItIsGiven) {
    int done = 0;
    Sliced work = twice(done);
    EXPECT_EQ(done, 0);
    EXPECT_EQ(work.run({.work = 0}), 0U);
    EXPECT_EQ(work.run({.work = 4}), 0U) << "the next piece costs 5";
    EXPECT_EQ(work.run({.work = 9}), 5U);
    EXPECT_EQ(done, 1);
    EXPECT_EQ(work.run({.work = 12}), 12U);
    EXPECT_EQ(done, 4);
    EXPECT_FALSE(work.isDone());
    EXPECT_EQ(work.run(), 2U);
    EXPECT_EQ(done, 5);
    EXPECT_TRUE(work.isDone());
    EXPECT_EQ(work.run(), 0U);
}

TEST(Sliced, NoPieceCostsMoreThanTheLeastUsefulSlice) {
    int done = 0;
    Sliced work = countUp(1, 1000, done);
    EXPECT_EQ(work.run({.work = mostSlicedPiece}), mostSlicedPiece);
    EXPECT_EQ(done, 1);
}

std::chrono::nanoseconds now{0};
std::chrono::nanoseconds tick() noexcept {
    return now += std::chrono::microseconds(1);
}

TEST(Sliced, TimeIsASecondStop) {
    int done = 0;
    Sliced work = countUp(1000, 1, done);
    Budget budget;
    budget.clock = tick;
    budget.time = std::chrono::microseconds(20);
    int slices = 0;
    for (; !work.isDone(); ++slices) {
        EXPECT_LE(work.run(budget), 20U);
        ASSERT_LT(slices, 1000);
    }
    EXPECT_EQ(done, 1000);
    EXPECT_GT(slices, 40);
}

TEST(Sliced, WhatAPartThrowsGoesUpThroughTheWhole) {
    int done = 0;
    Sliced work = failing(done);
    EXPECT_EQ(work.run({.work = 3}), 3U);
    EXPECT_THROW(work.run(), std::runtime_error);
    EXPECT_TRUE(work.isDone());
    bool caught = false;
    Sliced careful = catching(done = 0, caught);
    careful.run();
    EXPECT_TRUE(caught);
    EXPECT_EQ(done, 3);
}

TEST(Sliced, MayBeGivenUpHalfWay) {
    int done = 0;
    {
        Sliced work = twice(done);
        work.run({.work = 5});
    }
    EXPECT_EQ(done, 1);
}

TEST(Sliced, SortsLikeASort) {
    test::Random random(3);
    for (const int size : {0, 1, 63, 64, 65, 1000, 5000}) {
        std::vector<int> items(static_cast<std::size_t>(size) + 2);
        for (std::size_t i = 0; i < items.size(); ++i) {
            items[i] = static_cast<int>(2654435761U * static_cast<unsigned>(i) % 1000003U);
        }
        std::vector<int> expected = items;
        std::sort(expected.begin() + 1, expected.end() - 1);
        std::vector<int> spare;
        Sliced work = detail::sortSliced(items, 1, items.size() - 1, spare, std::less<>());
        while (!work.isDone()) {
            ASSERT_LE(work.run({.work = 9}), 9U);
        }
        EXPECT_EQ(items, expected);
    }
}

// Without optimisation (or under a sanitizer) too.
TEST(Sliced, PartsAfterPartsNeedNoStack) {
    constexpr int parts = 400'000;
    int done = 0;
    Sliced work = manyParts(parts, done);
    EXPECT_EQ(work.run(), static_cast<std::uint64_t>(parts));
    EXPECT_EQ(done, parts);
}

TEST(Sliced, TellsItsWorkAlsoWhenItThrows) {
    int done = 0;
    Sliced work = failing(done);
    EXPECT_THROW(work.run({.work = 100}), std::runtime_error);
    EXPECT_EQ(work.spent(), 6U);
}

/// Runs in slices of different sizes; the work.
std::uint64_t inSlices(Sliced work) {
    std::uint64_t sum = 0;
    for (std::uint64_t slice = 8; !work.isDone(); slice = slice % 50 + 8) {
        const std::uint64_t done = work.run({.work = slice});
        EXPECT_LE(done, slice);
        EXPECT_TRUE(done > 0 || work.isDone());
        sum += done;
    }
    return sum;
}

TEST(Sliced, MeshesAreLookedAtAsAtOnce) {
    scenes::Mesh open = scenes::torus(1, 0.3F, 40, 24);
    open.triangles.pop_back();
    for (const scenes::Mesh& mesh : {scenes::bumpySphere(1, 0.2F, 3, 12), open, scenes::grid(1, 1, 20, 20)}) {
        Topology topology;
        EXPECT_GT(inSlices(buildTopologyInSlices(mesh.view(), topology)), mesh.triangles.size() / 16);
        const Topology expected = buildTopology(mesh.view());
        EXPECT_EQ(topology.welded, expected.welded);
        EXPECT_EQ(topology.across, expected.across);
        EXPECT_EQ(topology.ringBegin, expected.ringBegin);
        EXPECT_EQ(topology.ring, expected.ring);
        EXPECT_EQ(topology.closed, expected.closed);
        MeshReport report;
        inSlices(inspectInSlices(mesh.view(), report));
        EXPECT_EQ(describe(report), describe(inspect(mesh.view())));
        ContentKey key;
        inSlices(contentKeyInSlices(mesh.view(), key));
        EXPECT_EQ(key, contentKey(mesh.view()));
        bool same = false;
        inSlices(sameContentInSlices(mesh.view(), mesh.view(), same));
        EXPECT_TRUE(same);
        scenes::Mesh other = mesh;
        other.vertices.back().x() += 1e-3F;
        inSlices(sameContentInSlices(mesh.view(), other.view(), same));
        EXPECT_FALSE(same);
    }
}

TEST(Sliced, FaultsOfAMeshAreFoundOnTheWay) {
    scenes::Mesh mesh = scenes::bumpySphere(1, 0.2F, 3, 12);
    mesh.vertices.back().y() = std::numeric_limits<float>::quiet_NaN();
    Sliced work = requireUsableInSlices(mesh.view());
    try {
        while (!work.isDone()) {
            work.run({.work = 8});
        }
        FAIL() << "a NaN passed";
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::notFinite);
    }
}

}  // namespace
}  // namespace grapeshot
