// Where two pieces of surface cross, how, and over what length, from their distributions alone: sixteen pairs of
// children at once.
//
// Of two Gaussian surfaces, with d from A's mean to B's and S = S_A + S_B,
//   length    = area_A area_B |n_A x n_B| N(d; 0, S)    the kinematic formula, for given normals
//   position  = mean_A + S_A S^-1 d                     mean of the product of both densities
//   extent^2  = tr S_A tr S_B / (tr S_A + tr S_B)       at least that of the product's covariance, whose trace it
//                                                       bounds from above; no matrices
// A piece whose normals spread has the mean over all angles, pi / 4, for the part that is not flat.
//
// This work is based on:
// Luis Santalo. Integral Geometry and Geometric Probability. 1976, (15.20): mean length of intersection curves
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_CROSSING_PAIR_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_CROSSING_PAIR_HPP
#undef GRAPESHOT_ADB_DETAIL_CROSSING_PAIR_HPP
#else
#define GRAPESHOT_ADB_DETAIL_CROSSING_PAIR_HPP
#endif

#include <grapeshot/adb/detail/surface_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// A's frame, metres.
struct Crossings {
    Float16 position[3];
    Float16 direction[3];  ///< normal of B minus normal of A, each as long as its surface is flat
    Float16 length;
    Float16 extent;
    Float16 flatness;  ///< of both, multiplied
    Float16 cosine;    ///< of the angle between the normals, times that
    Closeness closeness;
};

/// @param apart from A's box to B's, in A's frame, m
template <class SideA, class SideB>
HWY_INLINE Crossings crossingsOf(const PairPose& pose, SideA sideA, SideB sideB, const Float16 (&apart)[3]) {
    const SurfacePair pair = surfacePairOf(pose, sideA, sideB, apart);
    Crossings out;
    const Float16 perDeterminant = wide(1) / pair.determinant;
    const Float16 determinantOctaves = roughLog2(pair.determinant);
    out.closeness = {pair.product * perDeterminant, pair.determinant, pair.octaves};

    const Float16 h[3] = {pair.toward[0] * perDeterminant, pair.toward[1] * perDeterminant,
                          pair.toward[2] * perDeterminant};
    const Float16* const c = pair.covarianceA;
    const Float16 shift[3] = {c[0] * h[0] + c[1] * h[1] + c[2] * h[2], c[1] * h[0] + c[3] * h[1] + c[4] * h[2],
                              c[2] * h[0] + c[4] * h[1] + c[5] * h[2]};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        out.position[i] = sideA.wideOf(sideA.node->center[i]) + pair.offsetA[i] + shift[i];
    }
    const float perPerLength = 1 / pose.perLength;
    const Float16 traceA = c[0] + c[3] + c[5];
    const Float16 trace = pair.covariance[0] + pair.covariance[3] + pair.covariance[5];
    out.extent = wide(perPerLength) * sqrt(max(traceA * (trace - traceA) / trace, wide(0)));

    const Float4 flatA = fourTimes(1.0F / 255) * sideA.numbersOf(sideA.distribution->flatness);
    const Float4 flatB = fourTimes(1.0F / 255) * sideB.numbersOf(sideB.distribution->flatness);
    const Float4 inB[3] = {flatB * sideB.fourOf(sideB.node->normal[0]), flatB * sideB.fourOf(sideB.node->normal[1]),
                           flatB * sideB.fourOf(sideB.node->normal[2])};
    Float16 a[3];
    Float16 b[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        a[i] = spread(flatA * sideA.fourOf(sideA.node->normal[i]));
        b[i] = repeated(fourTimes(pose.row[i][0]) * inB[0] + fourTimes(pose.row[i][1]) * inB[1] +
                        fourTimes(pose.row[i][2]) * inB[2]);
        out.direction[i] = b[i] - a[i];
    }
    out.flatness = spread(flatA) * repeated(flatB);
    out.cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const Float16 sine = sqrt(max(out.flatness * out.flatness - out.cosine * out.cosine, wide(0))) +
                         wide(0.785398F) * (wide(1) - out.flatness);
    // log2 of (2 pi)^(3/2) is 3.97722; half of log2 of e is 0.7213475.
    const Float16 octaves = wide(1.0F / 256) * pair.octaves + wide(pose.areaOctaves) -
                            wide(0.5F) * determinantOctaves -
                            wide(0.7213475F) * squaredDistanceOf(pose, out.closeness) - wide(3.97722F);
    out.length = wide(perPerLength) * (sine * roughExp2(octaves));
    return out;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
