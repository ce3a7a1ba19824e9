// The search over neighbours against a plain one.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include <grapeshot/core/instruction_set.hpp>
#include <grapeshot/narrowphase/detail/piece_flood.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

namespace grapeshot {
namespace {

using detail::FloodPieces;
using Eigen::Vector3f;
using test::Random;

struct Ball {
    Vector3f position, direction;
    float radius;
};

/// Along a curve, so that blocks are compact as those of a traversal are, or anywhere.
std::vector<Ball> randomBalls(std::size_t count, bool alongCurve, float radius, Random& random) {
    std::vector<Ball> balls;
    Vector3f place = Vector3f::Zero();
    const Vector3f mean = random.direction();
    for (std::size_t i = 0; i < count; ++i) {
        place = alongCurve ? Vector3f(place + 0.06F * random.direction())
                           : Vector3f(Vector3f::NullaryExpr([&] { return static_cast<float>(random.unit()); }));
        const float own = random.bits() % 3 == 0 ? radius * static_cast<float>(random.unit()) : 0;
        balls.push_back({place, (mean + 1.5F * random.direction()).normalized(), own});
    }
    return balls;
}

void fill(FloodPieces& pieces, const std::vector<Ball>& balls) {
    pieces.reset(balls.size());
    for (const Ball& ball : balls) {
        pieces.add(ball.position, ball.direction, ball.radius);
    }
    pieces.finish();
}

std::set<std::uint32_t> plainFlood(const std::vector<Ball>& balls, std::vector<char>& candidate, std::uint32_t seed,
                                   float spacing, const Vector3f* axis, float cone) {
    std::vector<std::uint32_t> queue{seed};
    candidate[seed] = 0;
    for (std::size_t next = 0; next < queue.size(); ++next) {
        const Ball& from = balls[queue[next]];
        for (std::uint32_t i = 0; i < balls.size(); ++i) {
            const Ball& to = balls[i];
            if (candidate[i] != 0 && (to.position - from.position).norm() <= to.radius + (spacing + from.radius) &&
                (axis == nullptr || to.direction.dot(*axis) >= cone)) {
                candidate[i] = 0;
                queue.push_back(i);
            }
        }
    }
    return {queue.begin(), queue.end()};
}

TEST(PieceFlood, FindsWhatAPlainSearchFinds) {
    Random random(1);
    FloodPieces pieces;  // one for all: what it held before must not matter
    std::vector<std::uint32_t> found;
    std::size_t several = 0;
    std::size_t whole = 0;
    for (std::size_t trial = 0; trial < test::sampleSize(200, 2000); ++trial) {
        const std::size_t counts[] = {1, 2, 15, 16, 17, 64, 65, 300, 1025, 1 + random.bits() % 500};
        const std::vector<Ball> balls =
            randomBalls(counts[trial % 10], trial % 20 < 10, trial % 3 == 0 ? 0.3F : 0.03F, random);
        fill(pieces, balls);
        ASSERT_EQ(pieces.size(), balls.size());
        std::vector<char> candidate(balls.size(), 1);
        const float spacing = 0.05F + 0.03F * static_cast<float>(random.unit());
        const Vector3f axis = random.direction();
        const bool withAxis = trial % 2 == 0;
        std::size_t floods = 0;
        for (std::uint32_t seed = 0; seed < balls.size(); ++seed) {
            ASSERT_EQ(pieces.isCandidate(seed), candidate[seed] != 0);
            if (candidate[seed] == 0) {
                continue;
            }
            const auto expected = plainFlood(balls, candidate, seed, spacing, withAxis ? &axis : nullptr, 0.4F);
            pieces.flood(seed, spacing, withAxis ? &axis : nullptr, 0.4F, found);
            ASSERT_EQ(found.size(), expected.size()) << "each once";
            ASSERT_EQ(std::set(found.begin(), found.end()), expected);
            ASSERT_EQ(found.front(), seed);
            ++floods;
            if (floods == 2) {  // some are candidates again
                for (const std::uint32_t i : expected) {
                    pieces.makeCandidate(i);
                    candidate[i] = 1;
                }
            }
        }
        several += floods > 3 ? 1U : 0U;
        whole += floods == 1 ? 1U : 0U;
    }
    EXPECT_GT(several, 50U);
    EXPECT_GT(whole, 10U);
}

TEST(PieceFlood, ReachesExactlyToTheSpacing) {
    // On a grid whose distances are exact, also far from the origin; copies share places.
    for (const float origin : {0.0F, 1024.0F, -4096.0F}) {
        for (const std::size_t copies : {1, 3, 20}) {
            std::vector<Ball> balls;
            for (int i = 0; i < 40; ++i) {
                for (std::size_t copy = 0; copy < copies; ++copy) {
                    balls.push_back(
                        {Vector3f(origin, origin + 0.125F * static_cast<float>(i), 0), Vector3f::UnitX(), 0});
                }
            }
            FloodPieces pieces;
            std::vector<std::uint32_t> found;
            fill(pieces, balls);
            pieces.flood(0, 0.125F, nullptr, 0, found);
            EXPECT_EQ(found.size(), balls.size()) << origin << ", " << copies;
            fill(pieces, balls);
            pieces.flood(0, 0.1249F, nullptr, 0, found);
            EXPECT_EQ(found.size(), copies);
        }
    }
}

TEST(PieceFlood, HugeNumbersAreHarmless) {
    Random random(3);
    for (const float scale : {1e18F, 1e30F}) {
        for (const float spacing : {1.0F, 1e19F, std::numeric_limits<float>::max()}) {
            std::vector<Ball> balls = randomBalls(70, false, 0, random);  // more than a few blocks, and not sixteen
            for (Ball& ball : balls) {
                ball.position *= scale;
            }
            FloodPieces pieces;
            std::vector<std::uint32_t> found;
            fill(pieces, balls);
            std::set<std::uint32_t> all;
            for (std::uint32_t seed = 0; seed < balls.size(); ++seed) {
                if (pieces.isCandidate(seed)) {
                    pieces.flood(seed, spacing, nullptr, 0, found);
                    for (const std::uint32_t i : found) {
                        ASSERT_LT(i, balls.size());
                        ASSERT_TRUE(all.insert(i).second);
                    }
                }
            }
            EXPECT_EQ(all.size(), balls.size());
        }
    }
}

TEST(PieceFlood, SameOrderOnEveryInstructionSet) {
    const InstructionSet before = instructionSet();
    for (const std::size_t count : {30, 64, 700}) {
        Random random(4);
        const std::vector<Ball> balls = randomBalls(count, false, 0.03F, random);
        std::vector<std::vector<std::uint32_t>> first;
        for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
            limitInstructionSet(set);
            FloodPieces pieces;
            fill(pieces, balls);
            std::vector<std::vector<std::uint32_t>> all;
            for (std::uint32_t seed = 0; seed < count; ++seed) {
                if (pieces.isCandidate(seed)) {
                    pieces.flood(seed, 0.08F, nullptr, 0, all.emplace_back());
                }
            }
            first = first.empty() ? all : first;
            EXPECT_EQ(all, first);
        }
    }
    limitInstructionSet(before);
}

}  // namespace
}  // namespace grapeshot
