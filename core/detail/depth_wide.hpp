// Depth and middle of sixteen pairs of triangles that do overlap, beyond rounding.
//
// The depth is the smallest overlap along the two normals and the nine products of edges; the middle is that of the
// segment in which the triangles cut each other (Tomas Moller. A Fast Triangle-Triangle Intersection Test. 1997).
//
// No #pragma once: see wide.hpp.
#if defined(GRAPESHOT_CORE_DETAIL_DEPTH_WIDE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_DEPTH_WIDE_HPP
#undef GRAPESHOT_CORE_DETAIL_DEPTH_WIDE_HPP
#else
#define GRAPESHOT_CORE_DETAIL_DEPTH_WIDE_HPP
#endif

#include <grapeshot/core/detail/distance_wide.hpp>
#include <grapeshot/core/detail/overlap_wide.hpp>
#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

struct Depth16 {
    Float16 depth;
    Vector16 middle;
    Float16 featureA, featureB;
    Mask16 open;  ///< the winning axis is ill-conditioned
};

/// The corner of the other triangle that is deepest behind a face, given the three heights over it.
HWY_INLINE Float16 deepestCorner(Float16 h0, Float16 h1, Float16 h2) {
    const Float16 high = max(max(h0, h1), h2);
    const Float16 low = min(min(h0, h1), h2);
    const Float16 target = select(high <= -low, high, low);
    return select(h0 == target, wide(0), select(h1 == target, wide(1), wide(2)));
}

/// The two points where a triangle's outline crosses a plane, from the heights of its corners over it: two signs occur.
HWY_INLINE void crossings(const Vector16 (&corner)[3], Float16 h0, Float16 h1, Float16 h2, Vector16& first,
                          Vector16& second) {
    const Float16 zero = wide(0);
    const Mask16 above0 = h0 >= zero;
    const Mask16 above1 = h1 >= zero;
    const Mask16 above2 = h2 >= zero;
    const Mask16 lone1 = !(above0 ^ above2);
    const Mask16 lone0 = !(above1 ^ above2);  // wins
    const Vector16 lone = select(lone0, corner[0], select(lone1, corner[1], corner[2]));
    const Vector16 left = select(lone0, corner[1], select(lone1, corner[2], corner[0]));
    const Vector16 right = select(lone0, corner[2], select(lone1, corner[0], corner[1]));
    const Float16 h = select(lone0, h0, select(lone1, h1, h2));
    const Float16 hLeft = select(lone0, h1, select(lone1, h2, h0));
    const Float16 hRight = select(lone0, h2, select(lone1, h0, h1));
    const Float16 toLeft = h - hLeft;
    const Float16 toRight = h - hRight;
    first = lone + (left - lone) * clamp01(h / select(toLeft == zero, wide(1), toLeft));
    second = lone + (right - lone) * clamp01(h / select(toRight == zero, wide(1), toRight));
}

HWY_INLINE Vector16 middleOfCut(const Outlines16& o, const Normals16& n) {
    Vector16 a0, a1, b0, b1;
    crossings(o.a, -n.pc, n.p1 - n.pc, n.p2 - n.pc, a0, a1);
    crossings(o.b, n.qc, n.qc + n.q1, n.qc + n.q2, b0, b1);
    const Vector16 line = cross(n.nA, n.nB);
    const Float16 onLineA0 = dot(line, a0);
    const Float16 onLineA1 = dot(line, a1);
    const Float16 onLineB0 = dot(line, b0);
    const Float16 onLineB1 = dot(line, b1);
    const Mask16 swapA = onLineA1 < onLineA0;
    const Mask16 swapB = onLineB1 < onLineB0;
    const Mask16 startIsB = min(onLineB0, onLineB1) > min(onLineA0, onLineA1);
    const Mask16 endIsB = max(onLineB0, onLineB1) < max(onLineA0, onLineA1);
    const Vector16 start = select(startIsB, select(swapB, b1, b0), select(swapA, a1, a0));
    const Vector16 end = select(endIsB, select(swapB, b0, b1), select(swapA, a0, a1));
    return (start + end) * wide(0.5F);
}

HWY_INLINE Depth16 depthOf(const Outlines16& o, const Normals16& n, const NormalGaps16& normalGap,
                           const EdgeGaps16& edgeGap) {
    // Compared as squares of (depth times |axis|) over |axis|^2, crosswise.
    Float16 squared = normalGap.alongA * normalGap.alongA;
    Float16 axis = dot(n.nA, n.nA);
    Depth16 result;
    result.featureA = wide(6);
    result.featureB = deepestCorner(n.qc, n.qc + n.q1, n.qc + n.q2);
    result.open = noLane();
    {
        const Float16 squaredB = normalGap.alongB * normalGap.alongB;
        const Float16 axisB = dot(n.nB, n.nB);
        const Mask16 less = squaredB * axis < squared * axisB;
        squared = select(less, squaredB, squared);
        axis = select(less, axisB, axis);
        result.featureA = select(less, deepestCorner(-n.pc, n.p1 - n.pc, n.p2 - n.pc), result.featureA);
        result.featureB = select(less, wide(6), result.featureB);
    }
    for (int i = 0; i < 3; ++i) {
        const Float16 ee = dot(o.e[i], o.e[i]);
        for (int j = 0; j < 3; ++j) {
            const Vector16 across = cross(o.e[i], o.g[j]);
            const Float16 square = dot(across, across);
            const Float16 half = edgeGap.twice[i][j] * wide(0.5F);
            const Float16 squaredHere = half * half;
            const Mask16 less = squaredHere * axis < squared * square;
            squared = select(less, squaredHere, squared);
            axis = select(less, square, axis);
            result.featureA = select(less, wide(static_cast<float>(3 + i)), result.featureA);
            result.featureB = select(less, wide(static_cast<float>(3 + j)), result.featureB);
            // Edges within a degree of parallel: too much is lost in the triple products.
            const Mask16 narrow = square < ee * dot(o.g[j], o.g[j]) * wide(4e-4F);
            result.open = (narrow & less) | andNot(less, result.open);
        }
    }
    result.depth = sqrt(squared / select(axis > wide(0), axis, wide(1)));
    result.middle = middleOfCut(o, n);
    return result;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
