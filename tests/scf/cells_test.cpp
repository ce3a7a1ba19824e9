// Cuts through the tree, and the pairs of their cells that a step looks at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/front.hpp>
#include <grapeshot/scf/detail/key_map.hpp>
#include <grapeshot/scf/detail/pair_search.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

using CellPair = std::pair<std::uint32_t, std::uint32_t>;

TEST(Cells, OfARadiusAreTheLargestThatFit) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.2F, 7, 20).view());
    const detail::Cells cells = detail::cellsOfRadius(tree, 0.3F);
    EXPECT_GT(cells.cells.size(), 20U);
    std::vector<char> covered(tree.leaves.size(), 0);
    for (std::uint32_t cell = 0; cell < cells.cells.size(); ++cell) {
        EXPECT_LE(tree.own(cells.cells[cell]).radius, 0.3F);
        EXPECT_EQ(cells.cellAt(cells.cells[cell]), cell);
    }
    for (const BallNode& node : tree.nodes) {
        for (std::uint32_t slot = 0; slot < node.count; ++slot) {
            // Above a cell everything is larger.
            if (cells.isCell(node.child[slot]) && !isBallLeaf(node.child[slot])) {
                EXPECT_GT(node.own.radius, 0.3F);
            }
        }
    }
    EXPECT_THAT(cells.cellOfLeaf, testing::Each(testing::Lt(cells.cells.size())));
}

TEST(Cells, NeighboursShareAVertex) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.2F, 7, 12).view());
    const detail::Cells cells = detail::cellsOfRadius(tree, 0.3F);
    std::set<CellPair> expected;
    for (std::uint32_t v = 0; v < tree.surface.rest.size(); ++v) {
        for (const std::uint32_t t : tree.surface.fan.of(v)) {
            for (const std::uint32_t u : tree.surface.fan.of(v)) {
                if (cells.cellOf(tree, t) != cells.cellOf(tree, u)) {
                    expected.emplace(cells.cellOf(tree, t), cells.cellOf(tree, u));
                }
            }
        }
    }
    const IndexLists neighbours = detail::neighboursOfAll(tree, cells);
    detail::CellNeighbours asked;
    asked.begin(cells.cells.size());
    std::set<CellPair> listed;
    const auto count = static_cast<std::uint32_t>(cells.cells.size());
    for (std::uint32_t i = 0; i < 2 * count; ++i) {
        const std::uint32_t cell = i % 2 == 0 ? i / 2 : count - 1 - i / 2;  // in no order, each twice
        const auto around = neighbours.of(cell);
        EXPECT_THAT(asked.of(tree, cells, cell), testing::ElementsAreArray(around.begin(), around.end()));
        EXPECT_TRUE(std::ranges::is_sorted(around));
        for (const std::uint32_t other : around) {
            listed.emplace(cell, other);
        }
    }
    EXPECT_EQ(listed, expected);
}

TEST(Cells, OfACountAreAboutSoMany) {
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.2F, 7, 30).view());
    for (const std::size_t count : {16U, 64U, 200U}) {
        const std::size_t cells = detail::cellsOfCount(tree, count).cells.size();
        EXPECT_GE(cells, count);
        EXPECT_LE(cells, count + 3);
    }
    EXPECT_EQ(detail::cellsOfCount(tree, 100'000).cells.size(), tree.leaves.size());
}

TEST(Cells, OfACoarseMeshTellTrianglesApart) {
    const BallTree tree = buildBallTree(scenes::sphere(1, 4).view());
    const detail::Cells fine = detail::cellsOfRadius(tree, 0.01F);
    std::set<std::uint32_t> ids;
    for (std::uint32_t t = 0; t < tree.surface.triangles.size(); ++t) {
        ids.insert(fine.idOf(tree, t));
    }
    EXPECT_EQ(ids.size(), tree.surface.triangles.size());
    const detail::Cells coarse = detail::cellsOfRadius(tree, 10);
    for (std::uint32_t t = 0; t < tree.surface.triangles.size(); ++t) {
        EXPECT_EQ(coarse.idOf(tree, t), coarse.cellOf(tree, t));
    }
}

TEST(Front, HoldsEveryContactOnceForTwoBodiesAndForOne) {
    const TwoBumpy scene(12);
    const TwoBumpy::Frame where = scene.at(18);
    const Roll roll;
    const std::vector<Eigen::Vector3f> rolled = roll.at(2);
    detail::PosedTree a(scene.a);
    detail::PosedTree b(scene.b);
    detail::PosedTree r(roll.tree);
    a.begin(where.a, nullptr, measureStretch(scene.a.surface, where.a));
    b.begin(where.b, nullptr, measureStretch(scene.b.surface, where.b));
    r.begin(rolled, nullptr, measureStretch(roll.tree.surface, rolled));
    for (const detail::PairSpace& space : {detail::PairSpace{&a, &b, 0.05F, -1}, {&r, &r, 0.28F, 0.5F}}) {
        for (const std::size_t count : {16U, 50U, 1000U}) {
            const detail::Cells cellsA = detail::cellsOfCount(space.a->tree(), count);
            const detail::Cells cellsB = detail::cellsOfCount(space.b->tree(), count);
            std::set<CellPair> visited;
            detail::Front front;
            std::uint64_t work = 0;
            EXPECT_TRUE(front.run(
                space, cellsA, cellsB, work,
                [&](const detail::BallPair& pair, float weight) {
                    EXPECT_GE(weight, 0);
                    EXPECT_LE(weight, 1);
                    EXPECT_TRUE(visited.emplace(cellsA.cellAt(pair.a), cellsB.cellAt(pair.b)).second);
                    return true;
                },
                [] { return true; }));
            EXPECT_GT(work, 5U);
            std::size_t contacts = 0;
            detail::PairSearch search;
            search.run(space, {0, 0}, false, unlimited, [&](const detail::PairBatch& batch, int lane) {
                CellPair cells{cellsA.cellOf(space.a->tree(), batch.pair(lane).triangleA),
                               cellsB.cellOf(space.b->tree(), batch.pair(lane).triangleB)};
                if (space.isSelf() && cells.first > cells.second) {
                    std::swap(cells.first, cells.second);
                }
                EXPECT_TRUE(visited.contains(cells));
                ++contacts;
                return true;
            });
            EXPECT_GT(contacts, 100U);
            EXPECT_LT(visited.size(), cellsA.cells.size() * cellsB.cells.size());
            std::uint64_t few = 0;
            EXPECT_FALSE(front.run(
                space, cellsA, cellsB, few, [](const detail::BallPair&, float) { return true; },
                [&] { return few < 3; }));
            EXPECT_LE(few, 4U);
        }
    }
}

TEST(KeyMap, FindsWhatWasPutIn) {
    detail::KeyMap map;
    Random random(8);
    for (int round = 0; round < 3; ++round) {
        map.clear();
        EXPECT_EQ(map.size(), 0U);
        std::vector<std::uint64_t> keys;
        for (std::uint32_t i = 0; i < 3000; ++i) {
            keys.push_back(i % 3 == 0 ? random.bits() : std::uint64_t{i} << 32U | (i % 7));
            EXPECT_EQ(map.find(keys.back()), nullptr);
            EXPECT_TRUE(map.insert(keys.back(), i).isNew);
        }
        for (std::uint32_t i = 0; i < 3000; ++i) {
            ASSERT_NE(map.find(keys[i]), nullptr);
            EXPECT_EQ(*map.find(keys[i]), i);
            EXPECT_FALSE(map.insert(keys[i], 7).isNew);
        }
        EXPECT_EQ(map.size(), 3000U);
    }
}

}  // namespace
}  // namespace grapeshot::test
