// The list of neighbours that is kept from step to step, against the exact traversal in each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <grapeshot/scf/neighbour_list.hpp>

#include "tracked_scenes.hpp"

namespace grapeshot::test {
namespace {

using Positions = std::vector<Eigen::Vector3f>;

constexpr NeighbourSettings usual{0.1F, 0.05F, 0.5F};

std::vector<TrianglePair> sorted(std::vector<TrianglePair> pairs) {
    std::ranges::sort(pairs);
    return pairs;
}

/// Pairs within the distance where the surface is.
std::vector<TrianglePair> within(const BallTree& tree, const Positions& positions, const NeighbourSettings& how) {
    TrackSettings settings;
    settings.mode = TrackMode::exact;
    settings.maxDistance = how.distance;
    settings.exclusion = how.exclusion;
    std::vector<TrianglePair> pairs;
    for (const TrackedContact& contact :
         Tracker(tree).step({positions, {}, Stretch::measured(), {}}, settings).contacts) {
        pairs.push_back(contact.pair);
    }
    return sorted(pairs);
}

Positions between(const Positions& from, const Positions& to, float time) {
    Positions mixed;
    for (std::size_t i = 0; i < from.size(); ++i) {
        mixed.emplace_back(from[i] + time * (to[i] - from[i]));
    }
    return mixed;
}

void expectAllListed(const BallTree& tree, const NeighbourResult& found, const Positions& positions) {
    const std::vector<TrianglePair> listed = sorted(found.pairs);
    EXPECT_EQ(std::ranges::adjacent_find(listed), listed.end());
    const std::vector<TrianglePair> needed = within(tree, positions, usual);
    EXPECT_TRUE(std::ranges::includes(listed, needed)) << listed.size() << " listed, " << needed.size() << " needed";
}

TEST(NeighbourList, HasAllThatComesNearInTheStep) {
    const Roll roll;
    NeighbourList list(roll.tree);
    NeighbourResult found;
    std::size_t searched = 0;
    std::size_t needed = 0;
    for (int frame = 0; frame < 12; ++frame) {
        SCOPED_TRACE(frame);
        // Slow, fast, and not at all.
        const float speed = frame < 6 ? 0.2F : (frame < 9 ? 3.0F : 0.0F);
        const float now =
            frame < 6 ? 0.2F * static_cast<float>(frame) : 1.2F + std::min(3.0F * static_cast<float>(frame - 6), 9.0F);
        const Positions last = roll.at(now - speed);
        const Positions before = roll.at(now);
        const Positions after = roll.at(now + speed);
        list.find(last, before, after, usual, found);
        ASSERT_FALSE(found.fault);
        for (const Positions& moment : {last, after, between(before, after, 0.3F)}) {
            expectAllListed(roll.tree, found, moment);
        }
        needed += within(roll.tree, before, usual).size();
        searched += found.searched;
    }
    EXPECT_GT(needed, 100U);
    EXPECT_LT(searched, 12 * roll.tree.leaves.size());
}

TEST(NeighbourList, SearchesWhatHasMovedAndNothingElse) {
    const Roll roll;
    NeighbourList list(roll.tree);
    NeighbourResult found;
    Positions now = roll.at(1);
    list.find(now, now, now, usual, found);
    EXPECT_EQ(found.searched, roll.tree.leaves.size());
    const std::uint64_t whole = found.work;
    const std::vector<TrianglePair> pairs = found.pairs;
    list.find(now, now, now, usual, found);
    EXPECT_EQ(found.searched, 0U);
    EXPECT_EQ(found.pairs, pairs);
    EXPECT_LT(5 * found.work, whole);
    // It trembles within its reach.
    Positions shaken = now;
    for (std::size_t i = 0; i < shaken.size(); ++i) {
        shaken[i].x() += (i % 2 == 0 ? 0.2F : -0.2F) * usual.slack;
    }
    for (int step = 0; step < 10; ++step) {
        list.find(now, step % 2 == 0 ? shaken : now, now, usual, found);
        EXPECT_EQ(found.searched, 0U);
    }
    // One vertex goes far.
    now[7].y() += 0.1F;
    list.find(now, now, now, usual, found);
    EXPECT_GT(found.searched, 0U);
    EXPECT_LE(found.searched, 6U);
    expectAllListed(roll.tree, found, now);
    // Other settings: all anew.
    list.find(now, now, now, {0.12F, usual.slack, usual.exclusion}, found);
    EXPECT_EQ(found.searched, roll.tree.leaves.size());
}

TEST(NeighbourList, CopiesGoOnByThemselves) {
    const Roll roll;
    NeighbourList old(roll.tree);
    NeighbourResult found;
    for (int frame = 0; frame < 10; ++frame) {
        const Positions now = roll.at(0.5F * static_cast<float>(frame));
        old.find(now, now, now, usual, found);
    }
    NeighbourList copy = old;
    const Positions now = roll.at(5);
    NeighbourResult ofCopy;
    old.find(now, now, now, usual, found);
    copy.find(now, now, now, usual, ofCopy);
    EXPECT_EQ(found.pairs, ofCopy.pairs);
    EXPECT_EQ(found.work, ofCopy.work);
    expectAllListed(roll.tree, found, now);
}

TEST(NeighbourList, SaysWhatIsWrong) {
    const Roll roll;
    NeighbourList list(roll.tree);
    NeighbourResult found;
    Positions now = roll.at(1);
    list.find(now, now, now, {0.03F, 0, 0}, found);
    EXPECT_EQ(found.fault, Fault::badSetting);
    list.find(now, now, now, {-1, 0.01F, 0}, found);
    EXPECT_EQ(found.fault, Fault::badSetting);
    const Positions fewer(now.begin(), now.end() - 1);
    list.find(now, fewer, now, usual, found);
    EXPECT_EQ(found.fault, Fault::topologyChanged);
    list.find(now, now, now, usual, found);
    EXPECT_FALSE(found.fault);
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Positions broken = now;
        broken[100].z() = wrong;
        list.find(now, now, broken, usual, found);
        EXPECT_EQ(found.fault, Fault::notFinite);
        EXPECT_TRUE(found.pairs.empty());
    }
    list.find(now, now, now, usual, found);
    EXPECT_FALSE(found.fault);
    expectAllListed(roll.tree, found, now);
}

}  // namespace
}  // namespace grapeshot::test
