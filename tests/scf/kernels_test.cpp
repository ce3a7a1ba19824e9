// The kernels of ball and box pairs, against loops over their definitions, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/scf/detail/ball_kernels.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>

#include <adb/meshes.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

FourBalls randomBalls(Random& random) {
    FourBalls balls;
    for (int slot = 0; slot < 4; ++slot) {
        for (auto& axis : balls.center) {
            axis[slot] = static_cast<float>(random.uniform(-1, 1));
        }
        balls.radius[slot] = static_cast<float>(random.uniform(0, 0.8));
    }
    return balls;
}

float distance(const FourBalls& a, int i, const FourBalls& b, int j) {
    float square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        square += (a.center[axis][i] - b.center[axis][j]) * (a.center[axis][i] - b.center[axis][j]);
    }
    return std::sqrt(square);
}

TEST(BallKernels, DoWhatTheySayOnEveryInstructionSet) {
    const InstructionSetGuard guard;
    Random random(3);
    int touching = 0;
    int inside = 0;
    for (int round = 0; round < 200; ++round) {
        const FourBalls a = randomBalls(random);
        const FourBalls b = randomBalls(random);
        const auto reach = static_cast<float>(random.uniform(0, 0.1));
        float first[16] = {};
        std::uint32_t firstMask = 0;
        for (const InstructionSet set : instructionSets()) {
            limitInstructionSet(set);
            const std::uint32_t mask = detail::touchingBalls(a, b, reach);
            float weight[16];
            EXPECT_EQ(detail::overlappingBalls(a, b, reach, weight), mask);
            float gap[16];
            float again[16];
            detail::clearanceOfBalls(a, b, reach, gap, again);
            const std::uint32_t within = detail::ballsWithin(a, b, 1.2F);
            for (int lane = 0; lane < 16; ++lane) {
                const float sum = a.radius[lane / 4] + b.radius[lane % 4];
                const float d = distance(a, lane / 4, b, lane % 4);
                const bool touches = (mask >> lane & 1U) != 0U;
                if (std::abs(d - sum - reach) > 1e-5F) {
                    EXPECT_EQ(touches, d <= sum + reach);
                }
                EXPECT_LE(gap[lane], d - sum - reach);
                EXPECT_NEAR(gap[lane], d - sum - reach, 1e-5F);
                EXPECT_NEAR(again[lane], weight[lane], 1e-6F);
                EXPECT_NEAR(weight[lane], touches ? 1 - d / (sum + reach) : 0, 1e-5F);
                if (std::abs(d + sum - 1.2F) > 1e-5F) {
                    EXPECT_EQ((within >> lane & 1U) != 0U, d + sum <= 1.2F);
                }
                if (set == InstructionSet::scalar) {
                    touching += touches ? 1 : 0;
                    inside += static_cast<int>(within >> lane & 1U);
                    first[lane] = weight[lane];
                }
                EXPECT_EQ(first[lane], weight[lane]);
            }
            firstMask = set == InstructionSet::scalar ? mask : firstMask;
            EXPECT_EQ(mask, firstMask);
        }
    }
    EXPECT_GT(touching, 500);
    EXPECT_GT(inside, 50);
}

TEST(BallKernels, NothingThatIsNoNumberIsCulled) {
    Random random(4);
    FourBalls a = randomBalls(random);
    const FourBalls b = randomBalls(random);
    a.center[1][2] = std::nanf("");
    EXPECT_EQ(detail::touchingBalls(a, b, 0) >> 8U & 15U, 15U);
}

TEST(RowsKernel, FindsThePairsOfBoxesThatAreNear) {
    const InstructionSetGuard guard;
    const BallTree tree = buildBallTree(scenes::bumpySphere(1, 0.3F, 5, 6).view());
    detail::PosedTree a(tree);
    detail::PosedTree b(tree);
    const Pose pose{Eigen::Matrix3f::Identity(), {0.4F, 0.1F, 0}};
    a.begin(tree.surface.rest, nullptr, 1);
    b.begin(tree.surface.rest, &pose, 1);
    int near = 0;
    double allClear = 0;
    double allLeast = 0;
    for (std::uint32_t leafA = 0; leafA < tree.leaves.size(); ++leafA) {
        for (std::uint32_t leafB = 0; leafB < tree.leaves.size(); ++leafB) {
            const detail::PosedLeaf& p = a.leaf(leafA);
            const detail::PosedLeaf& q = b.leaf(leafB);
            for (const float exclusion : {-1.0F, 0.5F}) {
                for (const InstructionSet set : instructionSets()) {
                    limitInstructionSet(set);
                    std::uint16_t row[16];
                    const std::uint32_t units = detail::closeRows(p, q, 0.02F, exclusion, row);
                    EXPECT_GE(units, 1U);
                    EXPECT_LE(units, 17U);
                    std::uint16_t clear[16];
                    float clearance = 0;
                    EXPECT_LE(detail::clearRows(p, q, 0.02F, exclusion, clear, clearance), units);
                    float least = std::numeric_limits<float>::infinity();
                    for (unsigned i = 0; i < 16; ++i) {
                        for (unsigned j = 0; j < 16; ++j) {
                            bool expected = true;
                            float square = 0;
                            float gap = 0;
                            for (int axis = 0; axis < 3; ++axis) {
                                expected = expected && p.low[axis][i] - 0.02F <= q.high[axis][j] &&
                                           q.low[axis][j] <= p.high[axis][i] + 0.02F;
                                const float d = p.middle[axis][i] - q.middle[axis][j];
                                square += d * d;
                                const float apart = std::max(
                                    {0.0F, p.low[axis][i] - q.high[axis][j], q.low[axis][j] - p.high[axis][i]});
                                gap += apart * apart;
                            }
                            const bool isIn = exclusion < 0 || square > exclusion * exclusion;
                            if (std::abs(std::sqrt(gap) - 0.02F) > 1e-6F) {
                                EXPECT_EQ((clear[i] >> j & 1U) != 0U, isIn && std::sqrt(gap) < 0.02F);
                            }
                            if (isIn && (clear[i] >> j & 1U) == 0U) {
                                least = std::min(least, std::sqrt(gap) - 0.02F);
                            }
                            expected = expected && (exclusion < 0 || square > exclusion * exclusion);
                            EXPECT_EQ((row[i] >> j & 1U) != 0U, expected);
                            near += expected ? 1 : 0;
                        }
                    }
                    EXPECT_LE(clearance, std::max(least, 0.0F));
                    if (exclusion < 0) {
                        allClear += clearance;
                        allLeast += std::max(least, 0.0F);
                    }
                }
            }
        }
    }
    EXPECT_GT(near, 500);
    EXPECT_GT(allClear, 0.8 * allLeast);
}

}  // namespace
}  // namespace grapeshot::test
