// From one leaf pair over the neighbourhood to the whole patch.
#include <grapeshot/narrowphase/detail/patch_walk.hpp>

#include <gtest/gtest.h>

#include <algorithm>

#include <grapeshot/adb/query.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot {
namespace {

struct PatchWalkTest : testing::Test {
    MeshModel a = makeModel(scenes::bumpySphere(1, 0.05F, 4, 16).view());
    MeshModel b = makeModel(scenes::bumpySphere(0.8F, 0.04F, 5, 14).view());
    Pose pose{Eigen::Matrix3f::Identity(), {0.1F, 1.78F, 0.05F}};
    LocalContactSettings settings{.maxDistance = 0.1F};
    LocalContactSearch search;

    std::vector<SurfaceContact> finish() {
        std::vector<SurfaceContact> contacts;
        search.finish(contacts);
        return contacts;
    }
    /// All leaf pairs within the distance.
    std::vector<LeafPair> nearPairs() {
        LeafPairs found;
        Query(a.tree, b.tree).leafPairs(pose, {settings.maxDistance, Order::depthFirst}, {}, found);
        search.start(a, b, pose, settings);
        std::erase_if(found.pairs, [&](const LeafPair& pair) {
            std::uint32_t near = 0;
            search.addFew({&pair, 1}, unlimited, near);
            return near == 0;
        });
        std::sort(found.pairs.begin(), found.pairs.end());
        return found.pairs;
    }
};

bool same(const std::vector<SurfaceContact>& x, const std::vector<SurfaceContact>& y) {
    return std::ranges::equal(x, y, [](const SurfaceContact& one, const SurfaceContact& other) {
        return one.onA == other.onA && one.onB == other.onB && one.normal == other.normal;
    });
}

TEST_F(PatchWalkTest, ReachesAllOfAPatchFromAnyPartOfIt) {
    const std::vector<LeafPair> all = nearPairs();
    ASSERT_GT(all.size(), 50U);
    search.start(a, b, pose, settings);
    ASSERT_EQ(search.add(all), all.size());
    const std::vector<SurfaceContact> expected = finish();
    ASSERT_GT(expected.size(), 3U);
    detail::PatchWalk walk;
    for (std::size_t i = 0; i < all.size(); i += 7) {
        search.start(a, b, pose, settings);
        walk.start(a, b);
        walk.seed(all[i]);
        walk.seed(all[i]);
        Purse purse{Budget{}};
        EXPECT_TRUE(walk.run(purse, search));
        std::vector<LeafPair> reached(walk.reached().begin(), walk.reached().end());
        std::sort(reached.begin(), reached.end());
        // The walk knows the leaves by their boxes alone, the traversal somewhat better.
        EXPECT_TRUE(std::ranges::includes(reached, all)) << "from pair " << i;
        EXPECT_TRUE(same(finish(), expected));
        EXPECT_GE(purse.spent(), search.work());
    }
}

TEST_F(PatchWalkTest, GoesOnWhereABudgetEndedIt) {
    const std::vector<LeafPair> all = nearPairs();
    for (const std::uint64_t slice : {3U, 8U, 50U}) {
        search.start(a, b, pose, settings);
        detail::PatchWalk walk;
        walk.start(a, b);
        walk.seed(all.front());
        int slices = 0;
        for (bool done = false; !done && slices < 1000; ++slices) {
            Purse purse(Budget{.work = slice});
            done = walk.run(purse, search);
            EXPECT_LE(purse.spent(), slice);
        }
        EXPECT_GT(slices, 1);
        std::vector<LeafPair> reached(walk.reached().begin(), walk.reached().end());
        std::sort(reached.begin(), reached.end());
        EXPECT_TRUE(std::ranges::includes(reached, all)) << "in slices of " << slice;
        EXPECT_EQ(std::adjacent_find(reached.begin(), reached.end()), reached.end()) << "twice";
    }
}

TEST_F(PatchWalkTest, StaysWhereNothingIsNear) {
    pose.translation.y() = 5;
    search.start(a, b, pose, settings);
    detail::PatchWalk walk;
    walk.start(a, b);
    walk.seed({0, 0});
    Purse purse{Budget{}};
    EXPECT_TRUE(walk.run(purse, search));
    EXPECT_TRUE(walk.reached().empty());
    EXPECT_TRUE(finish().empty());
}

}  // namespace
}  // namespace grapeshot
