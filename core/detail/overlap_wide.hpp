// Separating axes of sixteen triangle pairs in single precision, with a bound
// on its error: each lane is proven separated, proven overlapping, or left
// open. Open lanes go to hard_triangles.hpp; on random pairs that is one in
// some thousands.
//
// This work is based on:
// Stefan Gottschalk. Separating axis theorem. TR96-024, UNC Chapel Hill. 1996
//
// Notation. A has the corners 0, a1, a2 and B the corners c, c + f1, c + f2:
// everything is relative to A's first corner. Edges run around: A's e0 = a1, e1
// = a2 - a1, e2 = -a2; B's g0 = f1, g1 = f2 - f1, g2 = -f2. Normals nA = a1 x
// a2, nB = f1 x f2. Along an axis e_i x g_j, the start of B's edge is at
//     s_ij = (e_i x g_j) . (b_j - a_i)
// seen from A's edge, A's third corner at u_j = -nA . g_j and B's third corner
// at w_i = e_i . nB from its edge. So A covers [0, u] and B s + [0, w], and
// they are apart by (|2 s + w - u| - |w| - |u|) / 2 (negative: they overlap by
// that much). By Laplace expansion all nine s_ij are sums of ten triple
// products: nA . {f1, f2, c}, nB . {a1, a2, c} and x_kl = a_k . (c x f_l). The
// axes are never formed.
//
// No #pragma once: see wide.hpp.
#if defined(GRAPESHOT_CORE_DETAIL_OVERLAP_WIDE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_OVERLAP_WIDE_HPP
#undef GRAPESHOT_CORE_DETAIL_OVERLAP_WIDE_HPP
#else
#define GRAPESHOT_CORE_DETAIL_OVERLAP_WIDE_HPP
#endif

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Sixteen pairs, relative to A's first corner.
struct Pairs16 {
    Vector16 origin;  ///< A's first corner
    Vector16 a1, a2, c, f1, f2;
    Float16 sizeA, sizeB,
        offset;  ///< largest |coordinate| of a1 and a2, of f1 and f2, of c
};

HWY_INLINE Float16 largest(Vector16 v) {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

HWY_INLINE Pairs16 relativePairs(Vector16 a0, Vector16 a1, Vector16 a2, Vector16 b0, Vector16 b1, Vector16 b2) {
    Pairs16 t{a0, a1 - a0, a2 - a0, b0 - a0, b1 - b0, b2 - b0, {}, {}, {}};
    t.sizeA = max(largest(t.a1), largest(t.a2));
    t.sizeB = max(largest(t.f1), largest(t.f2));
    t.offset = largest(t.c);
    return t;
}

/// Normals and the triple products with them.
struct Normals16 {
    Vector16 nA, nB;
    Float16 p1, p2, pc;  ///< nB . a1, a2, c
    Float16 q1, q2, qc;  ///< nA . f1, f2, c
};

HWY_INLINE Normals16 normalsOf(const Pairs16& t) {
    Normals16 n;
    n.nA = cross(t.a1, t.a2);
    n.nB = cross(t.f1, t.f2);
    n.p1 = dot(n.nB, t.a1);
    n.p2 = dot(n.nB, t.a2);
    n.pc = dot(n.nB, t.c);
    n.q1 = dot(n.nA, t.f1);
    n.q2 = dot(n.nA, t.f2);
    n.qc = dot(n.nA, t.c);
    return n;
}

/// Gap along both normals, in lengths times |n|; negative: overlap.
struct NormalGaps16 {
    Float16 alongA, alongB;
};

HWY_INLINE NormalGaps16 normalGaps(const Normals16& n) {
    const Float16 zero = wide(0);
    const Float16 lowB = n.qc + min(min(n.q1, n.q2), zero);
    const Float16 highB = n.qc + max(max(n.q1, n.q2), zero);
    const Float16 lowA = min(min(n.p1, n.p2), zero) - n.pc;
    const Float16 highA = max(max(n.p1, n.p2), zero) - n.pc;
    return {max(lowB, -highB), max(lowA, -highA)};
}

/// Twice the gaps along the nine edge axes, times |e_i x g_j|.
struct EdgeGaps16 {
    Float16 twice[3][3];
    Float16 widest;
};

HWY_INLINE EdgeGaps16 edgeGaps(const Pairs16& t, const Normals16& n) {
    const Vector16 m1 = cross(t.c, t.f1);
    const Vector16 m2 = cross(t.c, t.f2);
    const Float16 x11 = dot(t.a1, m1);
    const Float16 x12 = dot(t.a1, m2);
    const Float16 x21 = dot(t.a2, m1);
    const Float16 x22 = dot(t.a2, m2);
    const Float16 w1 = n.p2 - n.p1;
    const Float16 u1 = n.q2 - n.q1;  // -u_1
    const Float16 absW[3] = {abs(n.p1), abs(w1), abs(n.p2)};
    const Float16 absU[3] = {abs(n.q1), abs(u1), abs(n.q2)};
    const Float16 s01 = x11 - x12 - n.p1;
    const Float16 s10 = x11 - x21 - n.q1;
    const Float16 s21 = x22 - x21 + n.p2;
    const Float16 s12 = x22 - x12 + n.q2;
    // (a2 - a1) x (f2 - f1) . (c + f1 - a1)
    const Float16 s11 = -(s01 + s21) - u1;
    // 2 s_ij + w_i - u_j
    const Float16 middle[3][3] = {
        {n.p1 + n.q1 - (x11 + x11), (s01 + s01) + n.p1 + u1, (x12 + x12) + n.p1 - n.q2},
        {(s10 + s10) + w1 + n.q1, (s11 + s11) + w1 + u1, (s12 + s12) + w1 - n.q2},
        {(x21 + x21) - n.p2 + n.q1, (s21 + s21) - n.p2 + u1, -(x22 + x22) - n.p2 - n.q2},
    };
    EdgeGaps16 gaps;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            gaps.twice[i][j] = abs(middle[i][j]) - (absW[i] + absU[j]);
        }
    }
    gaps.widest = gaps.twice[0][0];
    for (int k = 1; k < 9; ++k) {
        gaps.widest = max(gaps.widest, gaps.twice[k / 3][k % 3]);
    }
    return gaps;
}

/// Is B beyond one of A's edges, seen in A's plane? Decides coplanar pairs.
HWY_INLINE Mask16 beyondAnEdge(Vector16 normal, Vector16 a1, Vector16 a2, Float16 sizeA, Vector16 c, Vector16 f1,
                               Vector16 f2, Float16 reach) {
    const Float16 zero = wide(0);
    const Vector16 start[3] = {{zero, zero, zero}, a1, a2};
    const Vector16 edge[3] = {a1, a2 - a1, -a2};
    const Float16 bound = wide(-0x1p-14F) * (sizeA * sizeA) * (sizeA * reach);
    Mask16 result = noLane();
    for (int i = 0; i < 3; ++i) {
        const Vector16 inward = cross(normal, edge[i]);
        const Float16 highest = dot(inward, c - start[i]) + max(max(dot(inward, f1), dot(inward, f2)), zero);
        result = result | (highest < bound);
    }
    return result;
}

struct Verdict16 {
    Mask16 separated, overlapping;  ///< neither: open
};

/// In this range of sizes no product over- or underflows into the error bounds.
HWY_INLINE Mask16 inRange(const Pairs16& t) {
    return (min(t.sizeA, t.sizeB) > wide(1e-8F)) & (max(max(t.sizeA, t.sizeB), t.offset) < wide(1e8F));
}

/// The bounds: a triple product of vectors with entries up to x, y, z has an
/// error below 30 x y z u, u = 2^-24; the sums over them add up to less than
/// 128 u (normals) and 600 u (edges).
HWY_INLINE Float16 normalBoundA(const Pairs16& t) {
    return wide(0x1p-16F) * (t.sizeA * t.sizeA) * (t.sizeB + t.offset);
}
HWY_INLINE Float16 normalBoundB(const Pairs16& t) {
    return wide(0x1p-16F) * (t.sizeB * t.sizeB) * (t.sizeA + t.offset);
}

HWY_INLINE Verdict16 normalVerdict(const Pairs16& t, const NormalGaps16& gaps) {
    const Float16 boundA = normalBoundA(t);
    const Float16 boundB = normalBoundB(t);
    return {(gaps.alongA > boundA) | (gaps.alongB > boundB), (gaps.alongA < -boundA) & (gaps.alongB < -boundB)};
}

/// `range`: lanes that may be decided here.
HWY_INLINE Verdict16 edgeVerdict(const Pairs16& t, const Normals16& n, const EdgeGaps16& gaps, Mask16 range,
                                 Verdict16 sofar) {
    const Float16 reach = t.sizeA + t.sizeB + t.offset;
    const Float16 bound = wide(0x1p-14F) * (t.sizeA * t.sizeB) * reach;
    Verdict16 verdict{range & (sofar.separated | (gaps.widest > bound)),
                      range & sofar.overlapping & (gaps.widest < -bound)};
    if (any(andNot(verdict.separated | verdict.overlapping, range))) {
        const Vector16 negativeC = -t.c;
        const Mask16 beyond = beyondAnEdge(n.nA, t.a1, t.a2, t.sizeA, t.c, t.f1, t.f2, reach) |
                              beyondAnEdge(n.nB, t.f1, t.f2, t.sizeB, negativeC, t.a1, t.a2, reach);
        verdict.separated = verdict.separated | andNot(verdict.overlapping, range & beyond);
    }
    return verdict;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
