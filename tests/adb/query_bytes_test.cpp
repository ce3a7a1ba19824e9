// A listing that is saved half way, loaded and resumed ends as the one that went on.
#include <gtest/gtest.h>

#include <cstring>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/bytes.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::test {
namespace {

std::vector<std::byte> bytesOf(const Query& query) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    query.save(out);
    return bytes;
}

struct SavedQuery : testing::Test {
    Tree a = build(scenes::torus(0.6F, 0.2F, 40, 20).view());
    Tree b = build(scenes::bumpySphere(0.5F, 0.1F, 5, 12).view());
    Pose pose{Eigen::Matrix3f::Identity(), {0.5F, 0.1F, 0}};
};

TEST_F(SavedQuery, LeafPairsGoOnAfterLoading) {
    for (const Order order : {Order::depthFirst, Order::bestFirst}) {
        for (const std::uint64_t stop : {0U, 1U, 5U, 40U, 1000000U}) {
            Query query(a, b);
            LeafPairs whole;
            query.leafPairs(pose, {0.05F, order}, {.work = stop}, whole);
            LeafPairs rest = whole;
            const std::vector<std::byte> bytes = bytesOf(query);
            ByteReader in(bytes);
            Query loaded = Query::load(a, b, in);
            EXPECT_EQ(in.left(), 0U);
            EXPECT_EQ(bytesOf(loaded), bytes);
            // In two parts, so that an order that only looks right is found out.
            for (const std::uint64_t more : {std::uint64_t{7}, unlimited}) {
                query.resumeLeafPairs({.work = more}, whole);
                loaded.resumeLeafPairs({.work = more}, rest);
                EXPECT_EQ(rest.pairs, whole.pairs);
                EXPECT_EQ(rest.work, whole.work);
                EXPECT_EQ(rest.certain, whole.certain);
            }
            EXPECT_TRUE(whole.certain);
            EXPECT_GT(whole.pairs.size(), 10U);
        }
    }
}

TEST_F(SavedQuery, ContactsGoOnAfterLoading) {
    for (const Order order : {Order::depthFirst, Order::bestFirst}) {
        Query query(a, b);
        Contacts whole;
        query.contacts(pose, {0.05F, order}, {.work = 30}, whole);
        ASSERT_FALSE(whole.certain);
        Contacts rest = whole;
        const std::vector<std::byte> bytes = bytesOf(query);
        ByteReader in(bytes);
        Query loaded = Query::load(a, b, in);
        query.resumeContacts({}, whole);
        loaded.resumeContacts({}, rest);
        ASSERT_EQ(rest.pairs.size(), whole.pairs.size());
        for (std::size_t i = 0; i < whole.pairs.size(); ++i) {
            EXPECT_EQ(rest.pairs[i].pair, whole.pairs[i].pair);
        }
        EXPECT_EQ(rest.work, whole.work);
    }
}

TEST_F(SavedQuery, OfADecisionThereIsNothingToResume) {
    Query query(a, b);
    static_cast<void>(query.decide(pose, DecideSettings::exact(), {.work = 1}));
    const std::vector<std::byte> bytes = bytesOf(query);
    EXPECT_EQ(bytes.size(), 1U);
    ByteReader in(bytes);
    EXPECT_EQ(Query::load(a, b, in).resume({}).stop, StopReason::invalidInput);
}

TEST_F(SavedQuery, WildBytesHaveANameOrDoNoHarm) {
    Query query(a, b);
    LeafPairs found;
    query.leafPairs(pose, {0.05F, Order::bestFirst}, {.work = 12}, found);
    const std::vector<std::byte> bytes = bytesOf(query);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        ByteReader in{std::span(bytes).first(size)};
        EXPECT_THROW(static_cast<void>(Query::load(a, b, in)), Error) << size;
    }
    int refused = 0;
    for (std::size_t at = 0; at + 4 <= bytes.size(); ++at) {
        for (const std::uint32_t number : {0xffffffffU, 0x7fc00000U, 5U, 0x80000003U}) {
            std::vector<std::byte> changed = bytes;
            std::memcpy(changed.data() + at, &number, sizeof number);
            ByteReader in(changed);
            try {
                Query loaded = Query::load(a, b, in);
                LeafPairs any;
                loaded.resumeLeafPairs({.work = 1000}, any);
                for (const LeafPair& pair : any.pairs) {
                    ASSERT_LT(pair.leafA, a.leaves.size());
                    ASSERT_LT(pair.leafB, b.leaves.size());
                }
            } catch (const Error& error) {
                EXPECT_EQ(error.fault(), Fault::badFile);
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace grapeshot::test
