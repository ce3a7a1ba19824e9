#include <grapeshot/core/triangle_batch.hpp>

#include <limits>

#include <grapeshot/core/detail/leaf_triangles.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>

#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/core/triangle_batch.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/depth_wide.hpp>
#include <grapeshot/core/detail/distance_wide.hpp>
#include <grapeshot/core/detail/overlap_wide.hpp>
#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Vector16 loadCorner(const TriangleBatch& batch, int corner) {
    return {load(batch.corner[corner][0]), load(batch.corner[corner][1]), load(batch.corner[corner][2])};
}

HWY_INLINE Pairs16 pairsOf(const TriangleBatch& a, const TriangleBatch& b) {
    return relativePairs(loadCorner(a, 0), loadCorner(a, 1), loadCorner(a, 2), loadCorner(b, 0), loadCorner(b, 1),
                         loadCorner(b, 2));
}

HWY_INLINE Vector16 spreadCorner(const float (&corner)[3][4]) {
    return {spreadA(corner[0]), spreadA(corner[1]), spreadA(corner[2])};
}

/// `pose`: rotation by rows, then translation.
HWY_INLINE Vector16 movedCorner(const float (&corner)[3][4], const float* pose) {
    const Float16 x = repeatB(corner[0]);
    const Float16 y = repeatB(corner[1]);
    const Float16 z = repeatB(corner[2]);
    return {wide(pose[0]) * x + wide(pose[1]) * y + wide(pose[2]) * z + wide(pose[9]),
            wide(pose[3]) * x + wide(pose[4]) * y + wide(pose[5]) * z + wide(pose[10]),
            wide(pose[6]) * x + wide(pose[7]) * y + wide(pose[8]) * z + wide(pose[11])};
}

HWY_INLINE Pairs16 pairsOfLeaves(const FourTriangles& a, const FourTriangles& b, const float* pose) {
    return relativePairs(spreadCorner(a[0]), spreadCorner(a[1]), spreadCorner(a[2]), movedCorner(b[0], pose),
                         movedCorner(b[1], pose), movedCorner(b[2], pose));
}

/// In the low half the lanes that overlap, in the high half those left open.
HWY_INLINE std::uint32_t overlapOf(const Pairs16& t) {
    const Mask16 range = inRange(t);
    const Normals16 n = normalsOf(t);
    Verdict16 verdict = normalVerdict(t, normalGaps(n));
    if (bits(verdict.separated & range) == 0xffffU) {
        return 0;
    }
    verdict = edgeVerdict(t, n, edgeGaps(t, n), range, verdict);
    return bits(verdict.overlapping) | (~bits(verdict.separated | verdict.overlapping) << 16U);
}

std::uint32_t overlapKernel(const TriangleBatch& a, const TriangleBatch& b) {
    return overlapOf(pairsOf(a, b));
}

std::uint32_t overlapLeavesKernel(const FourTriangles& a, const FourTriangles& b, const float* pose) {
    return overlapOf(pairsOfLeaves(a, b, pose));
}

HWY_INLINE void store3(Vector16 v, float (&out)[3][batchWidth]) {
    store(v.x, out[0]);
    store(v.y, out[1]);
    store(v.z, out[2]);
}

/// Lanes whose boxes, or one triangle and the other's plane, are surely farther
/// apart than `limit`.
HWY_INLINE Mask16 surelyBeyond(const Pairs16& t, const Normals16& n, const NormalGaps16& gap, Float16 limit) {
    const Float16 zero = wide(0);
    const Float16 safe = limit + wide(1e-6F) * (t.sizeA + t.sizeB + t.offset);
    const auto boxGap = [&](Float16 a1, Float16 a2, Float16 c, Float16 f1, Float16 f2) HWY_ATTR {
        const Float16 aboveA = c + min(min(f1, f2), zero) - max(max(a1, a2), zero);
        const Float16 belowA = min(min(a1, a2), zero) - (c + max(max(f1, f2), zero));
        return max(aboveA, belowA);
    };
    const Float16 box =
        max(max(boxGap(t.a1.x, t.a2.x, t.c.x, t.f1.x, t.f2.x), boxGap(t.a1.y, t.a2.y, t.c.y, t.f1.y, t.f2.y)),
            boxGap(t.a1.z, t.a2.z, t.c.z, t.f1.z, t.f2.z));
    const Float16 alongA = gap.alongA - normalBoundA(t);
    const Float16 alongB = gap.alongB - normalBoundB(t);
    const Float16 square = safe * safe;
    return (box > safe) | ((alongA > zero) & (alongA * alongA > square * dot(n.nA, n.nA))) |
           ((alongB > zero) & (alongB * alongB > square * dot(n.nB, n.nB)));
}

/// Fills `out`; returns the lanes left open, which are filled as if they did
/// not overlap. Lanes surely beyond `maxDistance` get the largest float, A's
/// first corner twice and features 0.
HWY_INLINE std::uint32_t distanceOf(const Pairs16& unscaled, float maxDistance, DistanceBatch& out) {
    const Float16 extent = max(max(unscaled.sizeA, unscaled.sizeB), unscaled.offset);
    const Float16 unit = powerOfTwoBelow(max(extent, wide(0x1p-126F)));
    const Float16 scale = wide(1) / unit;
    Pairs16 t = unscaled;
    t.a1 = t.a1 * scale;
    t.a2 = t.a2 * scale;
    t.c = t.c * scale;
    t.f1 = t.f1 * scale;
    t.f2 = t.f2 * scale;
    t.sizeA = t.sizeA * scale;
    t.sizeB = t.sizeB * scale;
    t.offset = t.offset * scale;
    const Float16 zero = wide(0);
    const Float16 farthest = wide(std::numeric_limits<float>::max());
    const Normals16 n = normalsOf(t);
    const NormalGaps16 normalGap = normalGaps(n);
    const Mask16 beyond = surelyBeyond(t, n, normalGap, min(wide(maxDistance) * scale, farthest));
    if (bits(beyond) == 0xffffU) {
        store(farthest, out.signedDistance);
        store3(t.origin, out.onA);
        store3(t.origin, out.onB);
        storeInt(zero, out.featureA);
        storeInt(zero, out.featureB);
        out.overlapping = 0;
        return 0;
    }
    const Vector16 b1 = t.c + t.f1;
    const Vector16 b2 = t.c + t.f2;
    const Outlines16 o{
        {{zero, zero, zero}, t.a1, t.a2}, {t.a1, t.a2 - t.a1, -t.a2}, {t.c, b1, b2}, {t.f1, t.f2 - t.f1, -t.f2}};

    // The same decisions as `overlaps`: all its quantities are scaled exactly.
    const Mask16 range = inRange(unscaled);
    const EdgeGaps16 edgeGap = edgeGaps(t, n);
    const Verdict16 verdict = edgeVerdict(t, n, edgeGap, range, normalVerdict(t, normalGap));
    const std::uint32_t overlapping = bits(verdict.overlapping);
    std::uint32_t open = ~bits(verdict.separated | verdict.overlapping | beyond) & 0xffffU;

    Closest16 result = closestPoints(o, n.nA, n.nB);
    if (overlapping != 0U) {
        const Depth16 deep = depthOf(o, n, normalGap, edgeGap);
        const Mask16 chosen = verdict.overlapping;
        result.distance = select(chosen, -deep.depth, result.distance);
        result.onA = select(chosen, deep.middle, result.onA);
        result.onB = select(chosen, deep.middle, result.onB);
        result.featureA = select(chosen, deep.featureA, result.featureA);
        result.featureB = select(chosen, deep.featureB, result.featureB);
        open |= bits(deep.open & chosen);
    }
    const Vector16 none{zero, zero, zero};
    store(select(beyond, farthest, result.distance * unit), out.signedDistance);
    store3(t.origin + select(beyond, none, result.onA * unit), out.onA);
    store3(t.origin + select(beyond, none, result.onB * unit), out.onB);
    storeInt(select(beyond, zero, result.featureA), out.featureA);
    storeInt(select(beyond, zero, result.featureB), out.featureB);
    out.overlapping = overlapping;
    return open;
}

std::uint32_t distanceKernel(const TriangleBatch& a, const TriangleBatch& b, float maxDistance, DistanceBatch& out) {
    return distanceOf(pairsOf(a, b), maxDistance, out);
}

std::uint32_t distanceLeavesKernel(const FourTriangles& a, const FourTriangles& b, const float* pose, float maxDistance,
                                   DistanceBatch& out) {
    return distanceOf(pairsOfLeaves(a, b, pose), maxDistance, out);
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <array>
#include <bit>

#include <grapeshot/core/detail/hard_triangles.hpp>
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot {

namespace detail {

namespace {

HardTriangle triangleOf(const TriangleBatch& batch, int lane) noexcept {
    HardTriangle triangle;
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            triangle.corner[corner][axis] = static_cast<double>(batch.corner[corner][axis][lane]);
        }
    }
    return triangle;
}

HardTriangle triangleOf(const FourTriangles& leaf, int lane) noexcept {
    HardTriangle triangle;
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            triangle.corner[corner][axis] = static_cast<double>(leaf[corner][axis][lane]);
        }
    }
    return triangle;
}

using PoseNumbers = std::array<float, 12>;

PoseNumbers numbersOf(const Pose& pose) noexcept {
    const auto& r = pose.rotation;
    const auto& x = pose.translation;
    return {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2), x[0], x[1], x[2]};
}

/// The same roundings as movedCorner.
HardTriangle movedTriangleOf(const FourTriangles& leaf, int lane, const PoseNumbers& pose) noexcept {
    HardTriangle triangle;
    for (int corner = 0; corner < 3; ++corner) {
        const float x = leaf[corner][0][lane];
        const float y = leaf[corner][1][lane];
        const float z = leaf[corner][2][lane];
        for (int axis = 0; axis < 3; ++axis) {
            const float* row = pose.data() + 3 * axis;
            const float moved = row[0] * x + row[1] * y + row[2] * z + pose.data()[9 + axis];
            triangle.corner[corner][axis] = static_cast<double>(moved);
        }
    }
    return triangle;
}

/// `pairAt(lane, a, b)` gives the corners of a lane.
template <class PairAt>
std::uint32_t settleOverlaps(std::uint32_t verdict, PairAt pairAt) noexcept {
    std::uint32_t overlapping = verdict & 0xffffU;
    for (std::uint32_t open = verdict >> 16U; open != 0U; open &= open - 1U) {
        const int lane = std::countr_zero(open);
        const auto [a, b] = pairAt(lane);
        if (hardOverlap(a, b)) {
            overlapping |= 1U << static_cast<unsigned>(lane);
        }
    }
    return overlapping;
}

template <class PairAt>
void settleDistances(std::uint32_t open, DistanceBatch& out, PairAt pairAt) noexcept {
    for (; open != 0U; open &= open - 1U) {
        const int lane = std::countr_zero(open);
        const auto [a, b] = pairAt(lane);
        const std::uint32_t bit = 1U << static_cast<unsigned>(lane);
        if ((out.overlapping & bit) == 0U && !hardOverlap(a, b)) {
            continue;
        }
        const HardDepth deep = hardDepth(a, b);
        out.overlapping |= bit;
        out.signedDistance[lane] = -static_cast<float>(deep.depth);
        for (int axis = 0; axis < 3; ++axis) {
            out.onA[axis][lane] = static_cast<float>(deep.middle[axis]);
            out.onB[axis][lane] = out.onA[axis][lane];
        }
        out.featureA[lane] = deep.featureA;
        out.featureB[lane] = deep.featureB;
    }
}

struct HardPair {
    HardTriangle a, b;
};

}  // namespace

std::uint32_t overlapsLeaves(const FourTriangles& a, const FourTriangles& b, const Pose& bInA) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(overlapLeavesKernel);
    const PoseNumbers pose = numbersOf(bInA);
    const std::uint32_t verdict = kernel.chosen()(a, b, pose.data());
    return settleOverlaps(verdict, [&](int lane) noexcept {
        return HardPair{triangleOf(a, lane / 4), movedTriangleOf(b, lane % 4, pose)};
    });
}

void signedDistancesLeaves(const FourTriangles& a, const FourTriangles& b, const Pose& bInA, DistanceBatch& out,
                           float maxDistance) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(distanceLeavesKernel);
    const PoseNumbers pose = numbersOf(bInA);
    const std::uint32_t open = kernel.chosen()(a, b, pose.data(), maxDistance, out);
    settleDistances(open, out, [&](int lane) noexcept {
        return HardPair{triangleOf(a, lane / 4), movedTriangleOf(b, lane % 4, pose)};
    });
}

static std::uint32_t overlapsBatch(const TriangleBatch& a, const TriangleBatch& b) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(overlapKernel);
    return settleOverlaps(kernel.chosen()(a, b), [&](int lane) noexcept {
        return HardPair{triangleOf(a, lane), triangleOf(b, lane)};
    });
}

static void signedDistancesBatch(const TriangleBatch& a, const TriangleBatch& b, DistanceBatch& out,
                                 float maxDistance) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(distanceKernel);
    settleDistances(kernel.chosen()(a, b, maxDistance, out), out, [&](int lane) noexcept {
        return HardPair{triangleOf(a, lane), triangleOf(b, lane)};
    });
}

}  // namespace detail

std::uint32_t overlaps(const TriangleBatch& a, const TriangleBatch& b) noexcept {
    return detail::overlapsBatch(a, b);
}

void signedDistances(const TriangleBatch& a, const TriangleBatch& b, DistanceBatch& out, float maxDistance) noexcept {
    detail::signedDistancesBatch(a, b, out, maxDistance);
}

}  // namespace grapeshot
#endif
