#include <grapeshot/scf/detail/ball_kernels.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>

#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/scf/detail/ball_kernels.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Float16 squaredCenterDistance(const FourBalls& a, const FourBalls& b) {
    const Vector16 d = Vector16{spreadA(a.center[0]), spreadA(a.center[1]), spreadA(a.center[2])} -
                       Vector16{repeatB(b.center[0]), repeatB(b.center[1]), repeatB(b.center[2])};
    return dot(d, d);
}

std::uint32_t touchingKernel(const FourBalls& a, const FourBalls& b, float reach) {
    const Float16 sum = spreadA(a.radius) + repeatB(b.radius) + wide(reach);
    return ~bits(squaredCenterDistance(a, b) > sum * sum) & 0xffffU;
}

std::uint32_t overlappingKernel(const FourBalls& a, const FourBalls& b, float reach, float (&weight)[16]) {
    const Float16 sum = spreadA(a.radius) + repeatB(b.radius) + wide(reach);
    const Float16 square = squaredCenterDistance(a, b);
    const Mask16 apart = square > sum * sum;
    const Float16 overlap = wide(1) - sqrt(square) / max(sum, wide(1e-30F));
    storeU(select(apart, wide(0), max(overlap, wide(0))), weight);
    return ~bits(apart) & 0xffffU;
}

std::uint32_t withinKernel(const FourBalls& a, const FourBalls& b, float distance) {
    const Float16 left = wide(distance) - spreadA(a.radius) - repeatB(b.radius);
    return bits((left >= wide(0)) & (squaredCenterDistance(a, b) <= left * left));
}

void gapsKernel(const FourBalls& a, const FourBalls& b, float (&gap)[16], float (&between)[16]) {
    const Float16 distance = sqrt(squaredCenterDistance(a, b));
    // The roundings of the difference, the square and the root.
    const Float16 left = distance * wide(1 - 1e-6F) - spreadA(a.radius) - repeatB(b.radius);
    storeU(select(left > wide(0), left, wide(0)), gap);
    storeU(distance, between);
}

void clearanceKernel(const FourBalls& a, const FourBalls& b, float reach, float (&gap)[16], float (&weight)[16]) {
    const Float16 sum = spreadA(a.radius) + repeatB(b.radius) + wide(reach);
    const Float16 distance = sqrt(squaredCenterDistance(a, b));
    // The roundings of the sum, the square and the root.
    const Float16 left = distance * wide(1 - 1e-6F) - sum * wide(1 + 1e-6F);
    storeU(select(left > wide(0), left, min(left, wide(0))), gap);
    const Float16 overlap = wide(1) - distance / max(sum, wide(1e-30F));
    storeU(select(overlap > wide(0), overlap, wide(0)), weight);
}

std::uint32_t rowsKernel(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                         std::uint16_t (&row)[16]) {
    const Float16 lowB[3] = {load(b.low[0]), load(b.low[1]), load(b.low[2])};
    const Float16 highB[3] = {load(b.high[0]), load(b.high[1]), load(b.high[2])};
    const auto nearBox = [&](const float* low, const float* high, int stride, const Float16(&l)[3],
                             const Float16(&h)[3]) HWY_ATTR {
        Mask16 inside = allLanes();
        for (int axis = 0; axis < 3; ++axis) {
            inside =
                inside & (l[axis] <= wide(high[axis * stride] + reach)) & (h[axis] >= wide(low[axis * stride] - reach));
        }
        return inside;
    };
    const Float16 lowA[3] = {load(a.low[0]), load(a.low[1]), load(a.low[2])};
    const Float16 highA[3] = {load(a.high[0]), load(a.high[1]), load(a.high[2])};
    const std::uint32_t near = bits(nearBox(b.boxLow, b.boxHigh, 1, lowA, highA));
    std::uint32_t units = 1;
    for (unsigned i = 0; i < 16; ++i) {
        row[i] = 0;
        if ((near >> i & 1U) == 0U) {
            continue;
        }
        ++units;
        Mask16 close = nearBox(a.low[0] + i, a.high[0] + i, 16, lowB, highB);
        if (exclusion >= 0) {
            const Vector16 d{load(b.middle[0]) - wide(a.middle[0][i]), load(b.middle[1]) - wide(a.middle[1][i]),
                             load(b.middle[2]) - wide(a.middle[2][i])};
            close = close & (dot(d, d) > wide(exclusion * exclusion));
        }
        row[i] = static_cast<std::uint16_t>(bits(close));
    }
    return units;
}

/// Between the boxes of sixteen triangles and one box, squared.
HWY_INLINE Float16 squaredBoxGap(const Float16 (&low)[3], const Float16 (&high)[3], const float* otherLow,
                                 const float* otherHigh, int stride) {
    Float16 square = wide(0);
    for (int axis = 0; axis < 3; ++axis) {
        const Float16 gap =
            max(max(low[axis] - wide(otherHigh[axis * stride]), wide(otherLow[axis * stride]) - high[axis]), wide(0));
        square = square + gap * gap;
    }
    return square;
}

std::uint32_t clearRowsKernel(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                              std::uint16_t (&row)[16], float& clearance) {
    const Float16 lowA[3] = {load(a.low[0]), load(a.low[1]), load(a.low[2])};
    const Float16 highA[3] = {load(a.high[0]), load(a.high[1]), load(a.high[2])};
    const Float16 lowB[3] = {load(b.low[0]), load(b.low[1]), load(b.low[2])};
    const Float16 highB[3] = {load(b.high[0]), load(b.high[1]), load(b.high[2])};
    const Float16 none = wide(3e38F);
    const Float16 close = wide(reach * reach * (1 + 1e-6F));
    const Float16 fromA = squaredBoxGap(lowA, highA, b.boxLow, b.boxHigh, 1);
    const Mask16 isFar = fromA > close;
    const std::uint32_t near = ~bits(isFar) & bits(lowA[0] <= highA[0]);
    Float16 least = select(isFar, fromA, none);
    std::uint32_t units = 1;
    for (unsigned i = 0; i < 16; ++i) {
        row[i] = 0;
        if ((near >> i & 1U) == 0U) {
            continue;
        }
        ++units;
        const Float16 square = squaredBoxGap(lowB, highB, a.low[0] + i, a.high[0] + i, 16);
        Mask16 kept = lowB[0] <= highB[0];
        if (exclusion >= 0) {
            const Vector16 d{load(b.middle[0]) - wide(a.middle[0][i]), load(b.middle[1]) - wide(a.middle[1][i]),
                             load(b.middle[2]) - wide(a.middle[2][i])};
            kept = kept & (dot(d, d) > wide(exclusion * exclusion));
        }
        const Mask16 apart = square > close;
        least = min(least, select(kept & apart, square, none));
        row[i] = static_cast<std::uint16_t>(bits(andNot(apart, kept)));
    }
    alignas(64) float square[16];
    store(least, square);
    float smallest = square[0];
    for (int lane = 1; lane < 16; ++lane) {
        smallest = square[lane] < smallest ? square[lane] : smallest;
    }
    const float gap = __builtin_sqrtf(smallest) * (1 - 1e-6F) - reach;
    clearance = gap > 0 ? gap : 0;
    return units;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

std::uint32_t touchingBalls(const FourBalls& a, const FourBalls& b, float reach) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(touchingKernel);
    return kernel.chosen()(a, b, reach);
}

std::uint32_t overlappingBalls(const FourBalls& a, const FourBalls& b, float reach, float (&weight)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(overlappingKernel);
    return kernel.chosen()(a, b, reach, weight);
}

std::uint32_t ballsWithin(const FourBalls& a, const FourBalls& b, float distance) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(withinKernel);
    return kernel.chosen()(a, b, distance);
}

void gapsOfBalls(const FourBalls& a, const FourBalls& b, float (&gap)[16], float (&between)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(gapsKernel);
    kernel.chosen()(a, b, gap, between);
}

void clearanceOfBalls(const FourBalls& a, const FourBalls& b, float reach, float (&gap)[16],
                      float (&weight)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(clearanceKernel);
    kernel.chosen()(a, b, reach, gap, weight);
}

std::uint32_t closeRows(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                        std::uint16_t (&row)[16]) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(rowsKernel);
    return kernel.chosen()(a, b, reach, exclusion, row);
}

std::uint32_t clearRows(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion, std::uint16_t (&row)[16],
                        float& clearance) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(clearRowsKernel);
    return kernel.chosen()(a, b, reach, exclusion, row, clearance);
}

}  // namespace grapeshot::detail
#endif
