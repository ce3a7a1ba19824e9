// How likely two pieces of surface meet, from their distributions alone: sixteen pairs of children at once.
//
// A piece of surface counts as a Gaussian: area, mean and covariance of its points. For two of them
//   D^2 = d^T (S_A + S_B)^-1 d            how far apart they are, in their own spreads
//   L = log2(area_A area_B / det(S_A + S_B)^(2/3))
// exp(-D^2 / 2) area_A area_B / sqrt(det(S_A + S_B)) is, up to a constant, what the kinematic formula gives for the
// expected length of the intersection curve; with 2/3 in place of 1/2 it is a number without unit.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003 (there
// the distribution is a count of well-filled cells, and the estimate hypergeometric)
// Luis Santalo. Integral Geometry and Geometric Probability. 1976, (15.20): mean length of intersection curves
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_SURFACE_PAIR_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_SURFACE_PAIR_HPP
#undef GRAPESHOT_ADB_DETAIL_SURFACE_PAIR_HPP
#else
#define GRAPESHOT_ADB_DETAIL_SURFACE_PAIR_HPP
#endif

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/detail/fused.hpp>
#include <grapeshot/adb/detail/node_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Float4 operator+(Float4 a, Float4 b) {
    return {a.lane + b.lane};
}
HWY_INLINE Float4 operator*(Float4 a, Float4 b) {
    return {a.lane * b.lane};
}
HWY_INLINE Float16 repeated(Float4 a) {
    return {{a.lane, a.lane, a.lane, a.lane}};
}
HWY_INLINE Float16 spread(Float4 a) {
    return {{Lanes{a.lane[0], a.lane[0], a.lane[0], a.lane[0]}, Lanes{a.lane[1], a.lane[1], a.lane[1], a.lane[1]},
             Lanes{a.lane[2], a.lane[2], a.lane[2], a.lane[2]}, Lanes{a.lane[3], a.lane[3], a.lane[3], a.lane[3]}}};
}
#else
HWY_INLINE Float4 operator+(Float4 a, Float4 b) {
    return {one::Add(a.lane, b.lane)};
}
HWY_INLINE Float4 operator*(Float4 a, Float4 b) {
    return {one::Mul(a.lane, b.lane)};
}
#if HWY_TARGET == HWY_AVX2
HWY_INLINE Float16 repeated(Float4 a) {
    const auto both = one::Combine(Register8(), a.lane, a.lane);
    return {both, both};
}
HWY_INLINE Float16 spread(Float4 a) {
    alignas(32) static constexpr std::int32_t first[8] = {0, 0, 0, 0, 1, 1, 1, 1};
    alignas(32) static constexpr std::int32_t second[8] = {2, 2, 2, 2, 3, 3, 3, 3};
    const auto both = one::Combine(Register8(), a.lane, a.lane);
    return {one::TableLookupLanes(both, one::SetTableIndices(Register(), first)),
            one::TableLookupLanes(both, one::SetTableIndices(Register(), second))};
}
#else
HWY_INLINE Float16 widened(Float4 a) {
    return {one::ZeroExtendVector(Register(), one::ZeroExtendVector(Register8(), a.lane))};
}
HWY_INLINE Float16 repeated(Float4 a) {
    return {one::TableLookupLanes(widened(a).all, one::SetTableIndices(Register(), repeatLanes[0]))};
}
HWY_INLINE Float16 spread(Float4 a) {
    return {one::TableLookupLanes(widened(a).all, one::SetTableIndices(Register(), spreadLanes[0]))};
}
#endif
#endif

/// Distributions of four children.
struct Surfaces {
    Float4 offset[3];  ///< of the centroid from the box's middle, m
    Float4 root[6];    ///< of the covariance, in the caller's unit: 00, 10, 11, 20, 21, 22
    Float4 octaves;    ///< log2 of the area in m^2, in 1 / 256
};
template <class Side>
HWY_INLINE Surfaces surfacesOf(Side side, float perLength) {
    const NodeDistribution& distribution = *side.distribution;
    const Float4 unit = fourTimes(1.0F / 127) * side.fourOf(distribution.size);
    const Float4 scaled = fourTimes(perLength) * unit;
    Surfaces out;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        out.offset[i] = side.numbersOf(distribution.mean[i]) * unit;
    }
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        out.root[i] = side.numbersOf(distribution.root[i]) * scaled;
    }
    out.octaves = side.numbersOf(distribution.area);
    return out;
}

/// xx, xy, xz, yy, yz, zz of a root times its transpose, given by columns.
HWY_INLINE void squared(const Float4 (&c0)[3], const Float4 (&c1)[3], const Float4 (&c2)[3], Float4 (&out)[6]) {
    int next = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
        for (int j = i; j < 3; ++j) {
            out[next++] = fused(c0[i], c0[j], fused(c1[i], c1[j], c2[i] * c2[j]));
        }
    }
}

/// The two Gaussians of sixteen pairs, put together; lengths of covariances in the caller's unit.
struct SurfacePair {
    Float16 offsetA[3];      ///< of A's centroid from its box's middle, m
    Float16 covarianceA[6];  ///< xx, xy, xz, yy, yz, zz; A's frame
    Float16 covariance[6];   ///< S_A + S_B
    Float16 determinant;     ///< of it
    Float16 toward[3];       ///< its adjugate times d, from A's mean to B's in m
    Float16 product;         ///< d times that
    Float16 octaves;         ///< log2(area_A area_B) in m^4, in 1 / 256
};

/// What D^2, L and rates are made of; in units that keep it within range.
struct Closeness {
    Float16 quotient;     ///< D^2 / perLength^2
    Float16 determinant;  ///< of S_A + S_B, times perLength^6
    Float16 octaves;      ///< log2(area_A area_B) in m^4, in 1 / 256
};

HWY_INLINE Float16 squaredDistanceOf(const PairPose& pose, const Closeness& closeness) {
    return wide(pose.perLength * pose.perLength) * closeness.quotient;
}
HWY_INLINE Float16 lengthOf(const PairPose& pose, const Closeness& closeness) {
    return wide(1.0F / 256) * closeness.octaves + wide(pose.areaOctaves) -
           wide(2.0F / 3) * roughLog2(closeness.determinant);
}

/// 2^(constant + distance D^2 + length L) with all factors put together, as the bits of a float: in octaves
/// times 2^23, with 127 added.
struct RateTerms {
    float start, quotient, determinant, octaves;
};
HWY_INLINE RateTerms rateTerms(const RateFormula& formula, const PairPose& pose) {
    const float share = -2.0F / 3 * formula.length;
    return {0x1p23F * (formula.constant + formula.length * pose.areaOctaves - share * 127 + 127),
            0x1p23F * formula.distance * (pose.perLength * pose.perLength), share, 0x1p23F / 256 * formula.length};
}
/// As rough as roughLog2 and roughExp2. Within 2^+-120; NaN counts as 2^-120.
HWY_INLINE Float16 ratesOf(const RateTerms& terms, const Closeness& closeness) {
    const Float16 bits = fused(wide(terms.quotient), closeness.quotient,
                               fused(wide(terms.determinant), bitsAsNumber(closeness.determinant),
                                     fused(wide(terms.octaves), closeness.octaves, wide(terms.start))));
    return numberAsBits(min(max(bits, wide(0x1p23F * 7)), wide(0x1p23F * 247)));
}

/// @param apart from A's box to B's, in A's frame, m
template <class SideA, class SideB>
HWY_INLINE SurfacePair surfacePairOf(const PairPose& pose, SideA sideA, SideB sideB, const Float16 (&apart)[3]) {
    const Surfaces a = surfacesOf(sideA, pose.perLength);
    const Surfaces b = surfacesOf(sideB, pose.perLength);

    const Float4(&rootA)[6] = a.root;
    const Float4 covarianceA[6] = {rootA[0] * rootA[0],
                                   rootA[0] * rootA[1],
                                   rootA[0] * rootA[3],
                                   fused(rootA[1], rootA[1], rootA[2] * rootA[2]),
                                   fused(rootA[1], rootA[3], rootA[2] * rootA[4]),
                                   fused(rootA[3], rootA[3], fused(rootA[4], rootA[4], rootA[5] * rootA[5]))};
    const Float4(&rootB)[6] = b.root;
    Float4 c0[3];
    Float4 c1[3];
    Float4 c2[3];
    Float4 offset[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const Float4 r0 = fourTimes(pose.row[i][0]);
        const Float4 r1 = fourTimes(pose.row[i][1]);
        const Float4 r2 = fourTimes(pose.row[i][2]);
        c0[i] = fused(r0, rootB[0], fused(r1, rootB[1], r2 * rootB[3]));
        c1[i] = fused(r1, rootB[2], r2 * rootB[4]);
        c2[i] = r2 * rootB[5];
        offset[i] = fused(r0, b.offset[0], fused(r1, b.offset[1], r2 * b.offset[2]));
    }
    Float4 covarianceB[6];
    squared(c0, c1, c2, covarianceB);

    SurfacePair out;
    Float16(&s)[6] = out.covariance;
    Float16 d[3];
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
        out.covarianceA[i] = spread(covarianceA[i]);
        s[i] = out.covarianceA[i] + repeated(covarianceB[i]);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        out.offsetA[i] = spread(a.offset[i]);
        d[i] = apart[i] + repeated(offset[i]) - out.offsetA[i];
    }
    const Float16 axx = fusedAway(s[4], s[4], s[3] * s[5]);
    const Float16 axy = fusedAway(s[1], s[5], s[2] * s[4]);
    const Float16 axz = fusedAway(s[2], s[3], s[1] * s[4]);
    const Float16 ayy = fusedAway(s[2], s[2], s[0] * s[5]);
    const Float16 ayz = fusedAway(s[0], s[4], s[1] * s[2]);
    const Float16 azz = fusedAway(s[1], s[1], s[0] * s[3]);
    out.determinant = max(fused(s[0], axx, fused(s[1], axy, s[2] * axz)), wide(1e-36F));
    out.toward[0] = fused(axx, d[0], fused(axy, d[1], axz * d[2]));
    out.toward[1] = fused(axy, d[0], fused(ayy, d[1], ayz * d[2]));
    out.toward[2] = fused(axz, d[0], fused(ayz, d[1], azz * d[2]));
    out.product = fused(d[0], out.toward[0], fused(d[1], out.toward[1], d[2] * out.toward[2]));
    out.octaves = spread(a.octaves) + repeated(b.octaves);
    return out;
}

HWY_INLINE Closeness closenessOf(const SurfacePair& pair) {
    return {pair.product / pair.determinant, pair.determinant, pair.octaves};
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
