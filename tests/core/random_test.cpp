#include <grapeshot/core/random.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <vector>

#include <support/test_size.hpp>

namespace grapeshot {
namespace {

// Known answers of Random123 1.14 (kat_vectors, philox4x32 10): the first two words of each block.
TEST(RandomBits, IsPhilox) {
    EXPECT_EQ(randomBits({0, 0, 0}, 0), 0xe169c58d6627e8d5U);
    EXPECT_EQ(randomBits({~0ULL, ~0ULL, 0xffffffffU}, 0xffffffffU), 0x41c83b0e408f276dU);
    EXPECT_EQ(randomBits({0x299f31d0a4093822U, 0x85a308d3243f6a88U, 0x13198a2eU}, 0x03707344U), 0x94fdccebd16cfe09U);
}

TEST(RandomBits, EveryPartOfTheKeyCounts) {
    const RandomKey key{0x123456789abcdef0U, 42, 7};
    std::set<std::uint64_t> seen = {randomBits(key, 0)};
    std::size_t expected = 1;
    for (int i = 0; i < 64; ++i) {
        const std::uint64_t flip = 1ULL << i;
        seen.insert(randomBits({key.seed ^ flip, key.pair, key.step}, 0));
        seen.insert(randomBits({key.seed, key.pair ^ flip, key.step}, 0));
        expected += 2;
        if (i < 32) {
            seen.insert(randomBits({key.seed, key.pair, key.step ^ flip}, 0));
            seen.insert(randomBits(key, static_cast<std::uint32_t>(flip)));
            expected += 2;
        } else {
            // The upper half of the step is folded into the seed: distinct within one seed.
            EXPECT_NE(randomBits({key.seed, key.pair, key.step ^ flip}, 0), randomBits(key, 0));
        }
    }
    EXPECT_EQ(seen.size(), expected);
}

TEST(RandomUnit, IsUniform) {
    const std::size_t n = test::sampleSize(200000, 20000000);
    constexpr std::size_t bins = 100;
    std::vector<double> count(bins);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const float x = randomUnit({3, i / 1000, i % 1000}, static_cast<std::uint32_t>(i % 7));
        ASSERT_GE(x, 0.0F);
        ASSERT_LT(x, 1.0F);
        ASSERT_EQ(x * 0x1p24F, static_cast<float>(static_cast<std::uint32_t>(x * 0x1p24F)));
        count[static_cast<std::size_t>(x * static_cast<float>(bins))] += 1;
        sum += static_cast<double>(x);
    }
    double chiSquared = 0;
    const double expected = static_cast<double>(n) / bins;
    for (const double c : count) {
        chiSquared += (c - expected) * (c - expected) / expected;
    }
    // 99 degrees of freedom: mean 99, standard deviation 14. Seeded, so this passes always or never.
    EXPECT_GT(chiSquared, 55);
    EXPECT_LT(chiSquared, 155);
    EXPECT_NEAR(sum / static_cast<double>(n), 0.5, 5 * 0.2887 / std::sqrt(static_cast<double>(n)));
}

TEST(RandomUnit, NeighbouringDrawsAreUncorrelated) {
    const std::size_t n = test::sampleSize(100000, 10000000);
    double draws = 0;
    double steps = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double x = randomUnit({1, 5, i}, 0) - 0.5;
        draws += x * (randomUnit({1, 5, i}, 1) - 0.5);
        steps += x * (randomUnit({1, 5, i + 1}, 0) - 0.5);
    }
    const double bound = 5.0 / 12.0 / std::sqrt(static_cast<double>(n));
    EXPECT_NEAR(draws / static_cast<double>(n), 0, bound);
    EXPECT_NEAR(steps / static_cast<double>(n), 0, bound);
}

TEST(PairKey, IgnoresTheOrder) {
    EXPECT_EQ(pairKey(3, 8), pairKey(8, 3));
    EXPECT_EQ(pairKey(3, 8), 0x0000000300000008U);
    EXPECT_NE(pairKey(3, 8), pairKey(3, 9));
}

}  // namespace
}  // namespace grapeshot
