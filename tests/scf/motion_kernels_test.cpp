// The kernels of swept balls and of moving triangles, against double precision, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <grapeshot/scf/detail/advance_kernels.hpp>
#include <grapeshot/scf/detail/sweep_kernels.hpp>

#include <adb/meshes.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

/// One ball as seen from another, in double precision.
struct Approach {
    Eigen::Vector3d from, path;
    double sum;  ///< m, of both radii and the reach
    [[nodiscard]] double distance(double time) const { return (from + time * path).norm(); }
    [[nodiscard]] double nearest() const {
        const double square = path.squaredNorm();
        return distance(square > 0 ? std::clamp(-from.dot(path) / square, 0.0, 1.0) : 0);
    }
    /// The smaller root of the quadratic.
    [[nodiscard]] std::optional<double> meeting() const {
        if (from.norm() <= sum) {
            return 0;
        }
        const double a = path.squaredNorm();
        const double b = from.dot(path);
        const double square = b * b - a * (from.squaredNorm() - sum * sum);
        if (!(square >= 0) || b >= 0) {
            return std::nullopt;
        }
        const double time = (from.squaredNorm() - sum * sum) / (-b + std::sqrt(square));
        return time <= 1 ? std::optional(time) : std::nullopt;
    }
};

struct SweepCounts {
    int meeting = 0, apart = 0;
};

/// @param rounding m, what may be taken for touching
void expectSwept(const Approach& pair, bool meets, float time, float limit, double rounding, SweepCounts& counts) {
    const std::optional<double> truth = pair.meeting();
    ++(truth ? counts.meeting : counts.apart);
    if (truth && *truth < static_cast<double>(limit)) {
        ASSERT_TRUE(meets);
    }
    if (!meets) {
        return;
    }
    EXPECT_LE(pair.nearest(), pair.sum + rounding);
    EXPECT_TRUE(time < limit || time == 0);
    if (truth) {
        ASSERT_LE(static_cast<double>(time), *truth);
    }
    // Not without need before it either.
    if (time > 0) {
        EXPECT_LE(pair.distance(static_cast<double>(time)), pair.sum + rounding + 3e-5 * pair.path.norm());
    }
}

/// Balls near the origin, or small ones far away from each other: `scale` m.
detail::SweptBalls randomSwept(Random& random, double scale) {
    detail::SweptBalls balls{};
    for (int slot = 0; slot < 4; ++slot) {
        const Eigen::Vector3f center = static_cast<float>(scale) * random.direction();
        // Towards the middle, more or less.
        const Eigen::Vector3f path = static_cast<float>(random.uniform(-0.2, 1.5)) *
                                     (static_cast<float>(random.uniform(0, 0.6)) * random.direction() - center);
        for (int axis = 0; axis < 3; ++axis) {
            balls.center[axis][slot] = center[axis];
            balls.path[axis][slot] = random.bits() % 16 == 0 ? 0 : path[axis];
        }
        balls.radius[slot] = static_cast<float>(random.uniform(0, 0.4));
    }
    return balls;
}

Approach approachOf(const detail::SweptBalls& a, int i, const detail::SweptBalls& b, int j, float reach) {
    Approach result{
        {}, {}, static_cast<double>(a.radius[i]) + static_cast<double>(b.radius[j]) + static_cast<double>(reach)};
    for (int axis = 0; axis < 3; ++axis) {
        result.from[axis] = static_cast<double>(a.center[axis][i]) - static_cast<double>(b.center[axis][j]);
        result.path[axis] = static_cast<double>(a.path[axis][i]) - static_cast<double>(b.path[axis][j]);
    }
    return result;
}

double overlapOf(const detail::SweptBalls& a, int i, const detail::SweptBalls& b, int j, float reach) {
    const Approach pair = approachOf(a, i, b, j, reach);
    const double share = pair.nearest() / std::max(pair.sum, 1e-9);
    return 1 - share * share;
}

TEST(SweepKernels, AreNeverLaterThanTheRootOfTheQuadratic) {
    const InstructionSetGuard guard;
    Random random(5);
    SweepCounts counts;
    for (int round = 0; round < 600; ++round) {
        const double scale = round % 3 == 0 ? 100 : 1;
        const double rounding = 4e-6 * scale;
        const detail::SweptBalls a = randomSwept(random, scale);
        const detail::SweptBalls b = randomSwept(random, scale);
        const auto reach = static_cast<float>(random.uniform(0, 0.1));
        const float limit = round % 2 == 0 ? 1.000001F : static_cast<float>(random.uniform(0, 1));
        detail::SweptLeaf leaf{};
        for (int lane = 0; lane < 16; ++lane) {
            for (int axis = 0; axis < 3; ++axis) {
                leaf.center[axis][lane] = a.center[axis][lane / 4] + 0.1F * static_cast<float>(lane % 4);
                leaf.path[axis][lane] = a.path[axis][lane / 4];
            }
            leaf.radius[lane] = a.radius[lane % 4];
        }
        const detail::SweptBall one{
            {b.center[0][0], b.center[1][0], b.center[2][0]}, {b.path[0][0], b.path[1][0], b.path[2][0]}, b.radius[0]};
        std::optional<std::pair<std::uint32_t, std::uint32_t>> first;
        float firstTime[32];
        float firstOverlap[32];
        for (const InstructionSet set : instructionSets()) {
            limitInstructionSet(set);
            float time[16];
            float leafTime[16];
            float overlap[16];
            float leafOverlap[16];
            const std::uint32_t mask = detail::sweptBallsMeet(a, b, reach, limit, time, overlap);
            const std::uint32_t leafMask = detail::sweptLeafMeets(one, leaf, reach, limit, leafTime, leafOverlap);
            if (!first) {
                first = {mask, leafMask};
                std::copy_n(time, 16, firstTime);
                std::copy_n(leafTime, 16, firstTime + 16);
                std::copy_n(overlap, 16, firstOverlap);
                std::copy_n(leafOverlap, 16, firstOverlap + 16);
            }
            ASSERT_EQ(std::pair(mask, leafMask), *first);
            for (int lane = 0; lane < 16; ++lane) {
                ASSERT_EQ(time[lane], firstTime[lane]);
                ASSERT_EQ(leafTime[lane], firstTime[lane + 16]);
                ASSERT_EQ(overlap[lane], firstOverlap[lane]);
                ASSERT_EQ(leafOverlap[lane], firstOverlap[lane + 16]);
                if ((mask >> lane & 1U) != 0U) {
                    EXPECT_NEAR(static_cast<double>(overlap[lane]), overlapOf(a, lane / 4, b, lane % 4, reach), 0.02);
                }
                expectSwept(approachOf(a, lane / 4, b, lane % 4, reach), (mask >> lane & 1U) != 0U, time[lane], limit,
                            rounding, counts);
                detail::SweptBalls single{};
                for (int axis = 0; axis < 3; ++axis) {
                    single.center[axis][0] = leaf.center[axis][lane];
                    single.path[axis][0] = leaf.path[axis][lane];
                }
                single.radius[0] = leaf.radius[lane];
                expectSwept(approachOf(single, 0, b, 0, reach), (leafMask >> lane & 1U) != 0U, leafTime[lane], limit,
                            rounding, counts);
            }
        }
    }
    EXPECT_GT(counts.meeting, 2000);
    EXPECT_GT(counts.apart, 2000);
}

TEST(SweepKernels, NothingThatIsNoNumberIsCulled) {
    Random random(4);
    detail::SweptBalls a = randomSwept(random, 1);
    detail::SweptBalls b = randomSwept(random, 1);
    a.center[1][2] = std::nanf("");
    b.path[0][1] = std::nanf("");
    float time[16];
    float overlap[16];
    const std::uint32_t mask = detail::sweptBallsMeet(a, b, 0, 1, time, overlap);
    EXPECT_EQ(mask >> 8U & 15U, 15U);
    EXPECT_EQ(mask & 0x2222U, 0x2222U);
}

/// Sixteen pairs of triangles, some near each other, and the way that each corner is bent.
struct MovingPairs {
    detail::MovingBatch batch;
    Eigen::Vector3d bend[2][3][16];  ///< m per step^2

    MovingPairs(Random& random, bool isBent) {
        for (int lane = 0; lane < 16; ++lane) {
            const auto size = static_cast<float>(random.uniform(0.05, 0.5));
            const Eigen::Vector3f gap = static_cast<float>(random.uniform(0, 1.2)) * random.direction();
            const Eigen::Vector3f speed = static_cast<float>(random.uniform(-0.3, 2)) * gap;
            double most[2];
            for (int side = 0; side < 2; ++side) {
                most[side] = isBent && lane % 4 != 0 ? random.uniform(0, 2) : 0;
                TriangleBatch& corners = side == 0 ? batch.a : batch.b;
                TriangleBatch& velocities = side == 0 ? batch.velocityA : batch.velocityB;
                for (int corner = 0; corner < 3; ++corner) {
                    const Eigen::Vector3f place =
                        size * random.direction() + (side == 0 ? Eigen::Vector3f::Zero() : gap);
                    const Eigen::Vector3f velocity =
                        0.2F * random.direction() - (side == 0 ? Eigen::Vector3f::Zero() : speed);
                    for (int axis = 0; axis < 3; ++axis) {
                        corners.corner[corner][axis][lane] = place[axis];
                        velocities.corner[corner][axis][lane] = velocity[axis];
                    }
                    bend[side][corner][lane] = most[side] * random.direction().cast<double>().normalized();
                }
            }
            batch.acceleration[lane] = static_cast<float>((most[0] + most[1]) * (1 + 1e-6));
        }
    }
    [[nodiscard]] Corners at(int side, int lane, double time) const {
        const TriangleBatch& corners = side == 0 ? batch.a : batch.b;
        const TriangleBatch& velocities = side == 0 ? batch.velocityA : batch.velocityB;
        Corners result;
        for (int corner = 0; corner < 3; ++corner) {
            Eigen::Vector3d& place = result[static_cast<std::size_t>(corner)];
            for (int axis = 0; axis < 3; ++axis) {
                place[axis] = static_cast<double>(corners.corner[corner][axis][lane]) +
                              time * static_cast<double>(velocities.corner[corner][axis][lane]);
            }
            place += 0.5 * time * time * bend[side][corner][lane];
        }
        return result;
    }
    [[nodiscard]] double distance(int lane, double time) const {
        return triangleDistance(at(0, lane, time), at(1, lane, time));
    }
};

void expectAdvance(bool isBent) {
    constexpr int samples = 40;
    const InstructionSetGuard guard;
    Random random(6);
    int touching = 0;
    int nearer = 0;
    int free = 0;
    for (int round = 0; round < 40; ++round) {
        const MovingPairs pairs(random, isBent);
        const float reach = round % 2 == 0 ? 0 : static_cast<float>(random.uniform(0, 0.1));
        constexpr float tolerance = 1e-5F;
        DistanceBatch apart;
        signedDistances(pairs.batch.a, pairs.batch.b, apart);
        std::optional<std::uint32_t> first;
        float firstStep[16];
        for (const InstructionSet set : instructionSets()) {
            limitInstructionSet(set);
            float step[16];
            const std::uint32_t mask = detail::advance(pairs.batch, apart, reach, tolerance, step);
            if (!first) {
                first = mask;
                std::copy_n(step, 16, firstStep);
            }
            ASSERT_EQ(mask, *first);
            ASSERT_TRUE(std::equal(step, step + 16, firstStep));
        }
        for (int lane = 0; lane < 16; ++lane) {
            const double now = pairs.distance(lane, 0);
            const double least = static_cast<double>(reach);
            if ((*first >> lane & 1U) != 0U) {
                ++touching;
                EXPECT_LE(now, least + 2e-5);
                EXPECT_EQ(firstStep[lane], 0);
                continue;
            }
            ASSERT_GT(now, least + 5e-6);
            ASSERT_GE(firstStep[lane], 0);
            const double end = std::min(static_cast<double>(firstStep[lane]), 2.0);
            for (int i = 1; i <= samples; ++i) {
                ASSERT_GE(pairs.distance(lane, end * i / samples), least) << round << " " << lane;
            }
            ++(firstStep[lane] > 2 ? free : nearer);
            if (firstStep[lane] <= 2) {
                EXPECT_GT(end, 0);
            }
        }
    }
    EXPECT_GT(touching, 40);
    EXPECT_GT(nearer, 200);
    EXPECT_GT(free, isBent ? 5 : 40);
}

TEST(AdvanceKernel, NothingTouchesWithinAStepOnStraightLines) {
    expectAdvance(false);
}

TEST(AdvanceKernel, NothingTouchesWithinAStepThatIsBent) {
    expectAdvance(true);
}

/// Where a face approaches a face, a step covers the gap; rounding costs what it must and no more.
TEST(AdvanceKernel, OneStepIsEnoughForParallelFaces) {
    detail::MovingBatch batch;
    for (int lane = 0; lane < 16; ++lane) {
        const float height = 0.5F + 0.1F * static_cast<float>(lane);
        const float corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
        for (int corner = 0; corner < 3; ++corner) {
            batch.a.corner[corner][0][lane] = batch.b.corner[corner][0][lane] = corners[corner][0];
            batch.a.corner[corner][1][lane] = batch.b.corner[corner][1][lane] = corners[corner][1];
            batch.b.corner[corner][2][lane] = height;
            batch.velocityA.corner[corner][2][lane] = 1;
            batch.velocityB.corner[corner][2][lane] = -1;
        }
        batch.acceleration[lane] = lane % 2 == 0 ? 0 : 2;
    }
    DistanceBatch apart;
    signedDistances(batch.a, batch.b, apart);
    float step[16];
    EXPECT_EQ(detail::advance(batch, apart, 0.1F, 1e-5F, step), 0U);
    for (int lane = 0; lane < 16; ++lane) {
        const double room = 0.4 + 0.1 * lane;
        // 2 s, and s^2 more where it is bent.
        const double truth = lane % 2 == 0 ? room / 2 : std::sqrt(1 + room) - 1;
        EXPECT_LE(static_cast<double>(step[lane]), truth);
        EXPECT_NEAR(static_cast<double>(step[lane]), truth, 1e-5);
    }
}

}  // namespace
}  // namespace grapeshot::test
