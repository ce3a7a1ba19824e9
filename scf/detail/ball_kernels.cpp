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

/// Row by row which triangles of B are close to one of A, of those that did not stand within the exclusion at rest.
/// @param near A's triangles that may have any. @param closeTo (i, lanes that count) -> lanes that are close
template <class CloseTo>
HWY_INLINE std::uint32_t fillRows(const PosedLeaf& a, const PosedLeaf& b, std::uint32_t near, float exclusion,
                                  std::uint16_t (&row)[16], const CloseTo& closeTo) {
    std::uint32_t units = 1;
    for (unsigned i = 0; i < 16; ++i) {
        row[i] = 0;
        if ((near >> i & 1U) == 0U) {
            continue;
        }
        ++units;
        Mask16 counted = allLanes();
        if (exclusion >= 0) {
            const Vector16 d{load(b.middle[0]) - wide(a.middle[0][i]), load(b.middle[1]) - wide(a.middle[1][i]),
                             load(b.middle[2]) - wide(a.middle[2][i])};
            counted = dot(d, d) > wide(exclusion * exclusion);
        }
        row[i] = static_cast<std::uint16_t>(bits(closeTo(i, counted)));
    }
    return units;
}

/// The boxes of sixteen triangles.
struct Boxes16 {
    Float16 low[3], high[3];
};
HWY_INLINE Boxes16 boxesOf(const PosedLeaf& leaf) {
    return {{load(leaf.low[0]), load(leaf.low[1]), load(leaf.low[2])},
            {load(leaf.high[0]), load(leaf.high[1]), load(leaf.high[2])}};
}

std::uint32_t rowsKernel(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                         std::uint16_t (&row)[16]) {
    const auto nearBox = [&](const Boxes16& boxes, const float* low, const float* high, int stride) HWY_ATTR {
        Mask16 inside = allLanes();
        for (int axis = 0; axis < 3; ++axis) {
            inside = inside & (boxes.low[axis] <= wide(high[axis * stride] + reach)) &
                     (boxes.high[axis] >= wide(low[axis * stride] - reach));
        }
        return inside;
    };
    const Boxes16 boxesB = boxesOf(b);
    const std::uint32_t near = bits(nearBox(boxesOf(a), b.boxLow, b.boxHigh, 1));
    return fillRows(a, b, near, exclusion, row, [&](unsigned i, Mask16 counted) HWY_ATTR {
        return nearBox(boxesB, a.low[0] + i, a.high[0] + i, 16) & counted;
    });
}

/// Between the boxes of sixteen triangles and one box, squared.
HWY_INLINE Float16 squaredBoxGap(const Boxes16& boxes, const float* otherLow, const float* otherHigh, int stride) {
    Float16 square = wide(0);
    for (int axis = 0; axis < 3; ++axis) {
        const Float16 gap =
            max(max(boxes.low[axis] - wide(otherHigh[axis * stride]), wide(otherLow[axis * stride]) - boxes.high[axis]),
                wide(0));
        square = square + gap * gap;
    }
    return square;
}

std::uint32_t clearRowsKernel(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                              std::uint16_t (&row)[16], float& clearance) {
    const Boxes16 boxesA = boxesOf(a);
    const Boxes16 boxesB = boxesOf(b);
    const Float16 none = wide(3e38F);
    const Float16 close = wide(reach * reach * (1 + 1e-6F));
    const Float16 fromA = squaredBoxGap(boxesA, b.boxLow, b.boxHigh, 1);
    const Mask16 isFar = fromA > close;
    const std::uint32_t near = ~bits(isFar) & bits(boxesA.low[0] <= boxesA.high[0]);
    const Mask16 used = boxesB.low[0] <= boxesB.high[0];
    Float16 least = select(isFar, fromA, none);
    const std::uint32_t units = fillRows(a, b, near, exclusion, row, [&](unsigned i, Mask16 counted) HWY_ATTR {
        const Float16 square = squaredBoxGap(boxesB, a.low[0] + i, a.high[0] + i, 16);
        const Mask16 kept = used & counted;
        const Mask16 apart = square > close;
        least = min(least, select(kept & apart, square, none));
        return andNot(apart, kept);
    });
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
