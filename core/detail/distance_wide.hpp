// Closest points of sixteen pairs of triangles that do not overlap: the nearest
// of nine edge-edge and six corner-face candidates, then refined.
//
// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, sections 5.1.5 (corner
// and face), 5.1.9 (segments)
//
// Every candidate is a point D = R + s U + t V of the difference of the two
// triangles and is compared by |D|^2 of the evaluated vector, never by a
// formula that cancels: what is reported is the distance of two points of the
// triangles, so it can only be too large, and after the refinement that is of
// second order.
//
// No #pragma once: see wide.hpp.
#if defined(GRAPESHOT_CORE_DETAIL_DISTANCE_WIDE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_DISTANCE_WIDE_HPP
#undef GRAPESHOT_CORE_DETAIL_DISTANCE_WIDE_HPP
#else
#define GRAPESHOT_CORE_DETAIL_DISTANCE_WIDE_HPP
#endif

#include <grapeshot/core/detail/overlap_wide.hpp>
#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Corners and edges of both triangles relative to A's first corner, scaled so
/// that the largest entry is in [1, 2).
struct Outlines16 {
    Vector16 a[3], e[3];  ///< A's corners; edge i runs from corner i to the next
    Vector16 b[3], g[3];
};

/// 1 / x, and 0 where x is not above `least`.
HWY_INLINE Float16 reciprocalAbove(Float16 x, Float16 least) {
    const Float16 one16 = wide(1);
    const Mask16 usable = x > least;
    return select(usable, one16 / select(usable, x, one16), wide(0));
}

HWY_INLINE Float16 clamp01(Float16 x) {
    return min(max(x, wide(0)), wide(1));
}

/// Squares of edges shorter than 1e-12 of the extent count as zero: such an
/// edge is a point.
HWY_INLINE Float16 leastSquare() {
    return wide(1e-24F);
}

/// The best candidate so far. Codes: 3 i + j for edges i and j, 9 + k for A's
/// corner k and B's face, 12 + k for B's corner k and A's face.
struct Nearest16 {
    Float16 squared, s, t, code;
};

HWY_INLINE void takeIfNearer(Nearest16& best, Mask16 allowed, Float16 squared, Float16 s, Float16 t, float code) {
    const Mask16 nearer = allowed & (squared < best.squared);
    best.squared = select(nearer, squared, best.squared);
    best.s = select(nearer, s, best.s);
    best.t = select(nearer, t, best.t);
    best.code = select(nearer, wide(code), best.code);
}

/// The nine pairs of edges. Worked on in stages, each of which is nine independent short chains: the processor overlaps
/// those, but not nine long ones.
struct EdgePairs16 {
    Float16 ee[3], gg[3], overE[3], overG[3];
    Float16 eg[9], er[9];  ///< r = a_i - b_j
    Float16 s[9], t[9], squared[9];
};

HWY_INLINE Vector16 edgeDifference(const Outlines16& o, int i, int j, Float16 s, Float16 t) {
    return o.a[i] - o.b[j] + o.e[i] * s - o.g[j] * t;
}

/// Between almost parallel edges the determinant has lost the crossing, and the pair may seem up to 7e-4 of the length
/// too far apart. One Newton step from the evaluated difference, with the determinant from the cross product, for those
/// that could be the nearest.
HWY_INLINE void crossAgain(EdgePairs16& p, const Outlines16& o, int i, int j, Mask16 where) {
    const int k = 3 * i + j;
    const Vector16 n = cross(o.e[i], o.g[j]);
    const Vector16 d = edgeDifference(o, i, j, p.s[k], p.t[k]);
    const Float16 over = reciprocalAbove(dot(n, n), p.ee[i] * p.gg[j] * wide(1e-11F) + wide(1e-36F));
    const Float16 de = dot(d, o.e[i]);
    const Float16 dg = dot(d, o.g[j]);
    const Float16 s0 = clamp01(p.s[k] + (p.eg[k] * dg - p.gg[j] * de) * over);
    const Float16 t = clamp01(p.t[k] + (dg + p.eg[k] * (s0 - p.s[k])) * p.overG[j]);
    const Float16 s = clamp01(p.s[k] + (p.eg[k] * (t - p.t[k]) - de) * p.overE[i]);
    const Vector16 moved = edgeDifference(o, i, j, s, t);
    const Float16 squared = dot(moved, moved);
    const Mask16 better = where & (squared < p.squared[k]);
    p.squared[k] = select(better, squared, p.squared[k]);
    p.s[k] = select(better, s, p.s[k]);
    p.t[k] = select(better, t, p.t[k]);
}

HWY_INLINE void tryEdges(Nearest16& best, const Outlines16& o) {
    EdgePairs16 p;
    for (int i = 0; i < 3; ++i) {
        p.ee[i] = dot(o.e[i], o.e[i]);
        p.gg[i] = dot(o.g[i], o.g[i]);
        p.overE[i] = reciprocalAbove(p.ee[i], leastSquare());
        p.overG[i] = reciprocalAbove(p.gg[i], leastSquare());
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int k = 3 * i + j;
            const Vector16 r = o.a[i] - o.b[j];
            const Float16 gr = dot(o.g[j], r);
            p.er[k] = dot(o.e[i], r);
            p.eg[k] = dot(o.e[i], o.g[j]);
            const Float16 product = p.ee[i] * p.gg[j];
            // Edges closer to parallel than rounding lets the determinant tell: any s will do to begin with.
            const Float16 over = reciprocalAbove(product - p.eg[k] * p.eg[k], product * wide(4e-7F) + wide(1e-36F));
            p.s[k] = clamp01((p.eg[k] * gr - p.er[k] * p.gg[j]) * over);
            p.t[k] = clamp01((p.eg[k] * p.s[k] + gr) * p.overG[j]);
        }
    }
    Float16 nearest = best.squared;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int k = 3 * i + j;
            p.s[k] = clamp01((p.eg[k] * p.t[k] - p.er[k]) * p.overE[i]);
            const Vector16 d = edgeDifference(o, i, j, p.s[k], p.t[k]);
            p.squared[k] = dot(d, d);
            nearest = min(nearest, p.squared[k]);
        }
    }
    Mask16 doubtful[9];
    Mask16 anyDoubtful = noLane();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int k = 3 * i + j;
            const Float16 product = p.ee[i] * p.gg[j];
            doubtful[k] = (product - p.eg[k] * p.eg[k] < product * wide(0.01F)) &
                          (p.squared[k] - max(p.ee[i], p.gg[j]) * wide(1e-6F) < nearest);
            anyDoubtful = anyDoubtful | doubtful[k];
        }
    }
    if (any(anyDoubtful)) {
        for (int k = 0; k < 9; ++k) {
            if (any(doubtful[k])) {
                crossAgain(p, o, k / 3, k % 3, doubtful[k]);
            }
        }
    }
    for (int k = 0; k < 9; ++k) {
        takeIfNearer(best, allLanes(), p.squared[k], p.s[k], p.t[k], static_cast<float>(k));
    }
}

/// Corners against the face corner + s u + t v.
HWY_INLINE void tryFace(Nearest16& best, const Vector16 (&corners)[3], Vector16 origin, Vector16 u, Vector16 v,
                        Vector16 normal, float firstCode) {
    const Float16 zero = wide(0);
    // A face lower than 1e-6 of its length has nothing that its edges do not have.
    const Float16 over = reciprocalAbove(dot(normal, normal), dot(u, u) * dot(v, v) * wide(1e-12F) + wide(1e-36F));
    const Mask16 isFace = over > zero;
    for (int k = 0; k < 3; ++k) {
        const Vector16 r = corners[k] - origin;
        // By areas: the Gram matrix of u and v loses the width of a sliver.
        const Float16 s = dot(cross(r, v), normal) * over;
        const Float16 t = dot(cross(u, r), normal) * over;
        const Vector16 d = r - u * s - v * t;
        const Mask16 inside = isFace & (s >= zero) & (t >= zero) & (s + t <= wide(1));
        takeIfNearer(best, inside, dot(d, d), s, t, firstCode + static_cast<float>(k));
    }
}

/// A chosen candidate: D = r + s u + t v.
struct Candidate16 {
    Vector16 r, u, v;
    Mask16 i1, i2, j1, j2;  ///< which corner or edge of A and of B
    Mask16 faceOfB, faceOfA;
};

HWY_INLINE Mask16 codeIn(Float16 code, float first, float last) {
    return (code >= wide(first)) & (code <= wide(last));
}
HWY_INLINE Mask16 codeIs(Float16 code, float value) {
    return code == wide(value);
}

HWY_INLINE Candidate16 decode(const Outlines16& o, Float16 code) {
    Candidate16 c;
    c.i1 = codeIn(code, 3, 5) | codeIs(code, 10);
    c.i2 = codeIn(code, 6, 8) | codeIs(code, 11);
    c.j1 = codeIs(code, 1) | codeIs(code, 4) | codeIs(code, 7) | codeIs(code, 13);
    c.j2 = codeIs(code, 2) | codeIs(code, 5) | codeIs(code, 8) | codeIs(code, 14);
    c.faceOfB = codeIn(code, 9, 11);
    c.faceOfA = code >= wide(12);
    c.r = select(c.i2, o.a[2], select(c.i1, o.a[1], o.a[0])) - select(c.j2, o.b[2], select(c.j1, o.b[1], o.b[0]));
    const Vector16 edgeA = select(c.i2, o.e[2], select(c.i1, o.e[1], o.e[0]));
    const Vector16 edgeB = select(c.j2, o.g[2], select(c.j1, o.g[1], o.g[0]));
    // Faces: A's is spanned by a1 = e0 and a2 = -e2, B's likewise and subtracted.
    c.u = select(c.faceOfA, o.e[0], select(c.faceOfB, -o.g[0], edgeA));
    c.v = select(c.faceOfA, -o.e[2], select(c.faceOfB, o.g[2], -edgeB));
    return c;
}

/// Newton steps on |D|^2 from the evaluated D: repairs what the determinant
/// loses between almost parallel edges.
HWY_INLINE void refine(const Candidate16& c, Float16& s, Float16& t, Vector16& d) {
    const Float16 zero = wide(0);
    const Mask16 face = c.faceOfA | c.faceOfB;
    const Float16 uu = dot(c.u, c.u);
    const Float16 vv = dot(c.v, c.v);
    const Float16 uv = dot(c.u, c.v);
    const Vector16 n = cross(c.u, c.v);
    const Float16 over = reciprocalAbove(dot(n, n), uu * vv * wide(1e-11F) + wide(1e-36F));
    const Float16 overU = reciprocalAbove(uu, leastSquare());
    const Float16 overV = reciprocalAbove(vv, leastSquare());
    d = c.r + c.u * s + c.v * t;
    for (int step = 0; step < 2; ++step) {
        const Float16 du = dot(d, c.u);
        const Float16 dv = dot(d, c.v);
        const Float16 newS = s + (uv * dv - vv * du) * over;
        const Float16 newT = t + (uv * du - uu * dv) * over;
        // Edges: clamp s, then the best t for it, then the best s for that.
        const Float16 edgeS = clamp01(newS);
        const Float16 edgeT = clamp01(t - (dv + uv * (edgeS - s)) * overV);
        const Float16 lastS = clamp01(s - (du + uv * (edgeT - t)) * overU);
        // Faces: the corner projects into the face, up to rounding.
        const Float16 faceS = clamp01(newS);
        const Float16 faceT = min(max(newT, zero), wide(1) - faceS);
        const Float16 nextS = select(face, faceS, lastS);
        const Float16 nextT = select(face, faceT, edgeT);
        const Vector16 next = c.r + c.u * nextS + c.v * nextT;
        const Mask16 better = dot(next, next) < dot(d, d);
        s = select(better, nextS, s);
        t = select(better, nextT, t);
        d = select(better, next, d);
    }
}

/// Result in the scaled frame.
struct Closest16 {
    Float16 distance;
    Vector16 onA, onB;
    Float16 featureA, featureB;
};

/// Corner if the parameter is at an end, else the edge.
HWY_INLINE Float16 featureOfEdge(Mask16 first, Mask16 second, Float16 parameter) {
    const Float16 edge = select(second, wide(5), select(first, wide(4), wide(3)));
    const Float16 start = edge - wide(3);
    const Float16 end = select(second, wide(0), start + wide(1));
    return select(parameter <= wide(0), start, select(parameter >= wide(1), end, edge));
}

HWY_INLINE Closest16 closestPoints(const Outlines16& o, Vector16 nA, Vector16 nB) {
    const Float16 zero = wide(0);
    Nearest16 best{wide(1e30F), zero, zero, zero};
    tryEdges(best, o);
    tryFace(best, o.a, o.b[0], o.g[0], -o.g[2], nB, 9);
    tryFace(best, o.b, o.a[0], o.e[0], -o.e[2], nA, 12);
    const Candidate16 c = decode(o, best.code);
    Vector16 d;
    refine(c, best.s, best.t, d);

    Closest16 result;
    result.distance = sqrt(dot(d, d));
    const Vector16 su = c.u * best.s;
    const Vector16 tv = c.v * best.t;
    const Vector16 none{zero, zero, zero};
    const Vector16 cornerA = select(c.i2, o.a[2], select(c.i1, o.a[1], o.a[0]));
    const Vector16 cornerB = select(c.j2, o.b[2], select(c.j1, o.b[1], o.b[0]));
    result.onA = cornerA + select(c.faceOfB, none, select(c.faceOfA, su + tv, su));
    result.onB = cornerB - select(c.faceOfA, none, select(c.faceOfB, su + tv, tv));
    const Float16 cornerIndexA = select(c.i2, wide(2), select(c.i1, wide(1), zero));
    const Float16 cornerIndexB = select(c.j2, wide(2), select(c.j1, wide(1), zero));
    result.featureA = select(c.faceOfA, wide(6), select(c.faceOfB, cornerIndexA, featureOfEdge(c.i1, c.i2, best.s)));
    result.featureB = select(c.faceOfB, wide(6), select(c.faceOfA, cornerIndexB, featureOfEdge(c.j1, c.j2, best.t)));
    return result;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
