// a b + c rounded once, for sixteen floats and for four: the same bytes on every instruction set. For the estimate
// alone; what decides exactly rounds products and sums apart, which its slack is made for.
//
// This work is based on:
// Sylvie Boldo, Guillaume Melquiond. Emulation of a FMA and Correctly Rounded Sums: Proved Algorithms Using Rounding to
// Odd. IEEE Transactions on Computers 57(4), 2008
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_FUSED_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_FUSED_HPP
#undef GRAPESHOT_ADB_DETAIL_FUSED_HPP
#else
#define GRAPESHOT_ADB_DETAIL_FUSED_HPP
#endif

#include <grapeshot/adb/detail/node_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
using TwoFloats = float __attribute__((vector_size(8)));
using TwoDoubles = double __attribute__((vector_size(16)));
using TwoLongs = std::int64_t __attribute__((vector_size(16)));

/// The product is exact in double. The sum is rounded to odd there, so that rounding it again, to float, comes to what
/// rounding it once would have.
HWY_INLINE TwoFloats fused(TwoFloats a, TwoFloats b, TwoFloats c) {
    const TwoDoubles product = __builtin_convertvector(a, TwoDoubles) * __builtin_convertvector(b, TwoDoubles);
    const TwoDoubles summand = __builtin_convertvector(c, TwoDoubles);
    const TwoDoubles sum = product + summand;
    const TwoDoubles back = sum - product;
    const TwoDoubles rest = (product - (sum - back)) + (summand - back);  // exact; NaN if the sum is not finite
    const TwoLongs bits = __builtin_bit_cast(TwoLongs, sum);
    const TwoLongs inexact = (rest < 0) | (rest > 0);
    const TwoLongs outwards = 1 + 2 * ((rest > 0) ^ (sum > 0));
    const TwoLongs odd = bits + (inexact & ((bits & 1) == 0) & outwards);
    return __builtin_convertvector(__builtin_bit_cast(TwoDoubles, odd), TwoFloats);
}
HWY_INLINE Lanes fused(Lanes a, Lanes b, Lanes c) {
    const TwoFloats low = fused(__builtin_shufflevector(a, a, 0, 1), __builtin_shufflevector(b, b, 0, 1),
                                __builtin_shufflevector(c, c, 0, 1));
    const TwoFloats high = fused(__builtin_shufflevector(a, a, 2, 3), __builtin_shufflevector(b, b, 2, 3),
                                 __builtin_shufflevector(c, c, 2, 3));
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}
HWY_INLINE Float4 fused(Float4 a, Float4 b, Float4 c) {
    return {fused(a.lane, b.lane, c.lane)};
}
HWY_INLINE Float16 fused(Float16 a, Float16 b, Float16 c) {
    return {{fused(a.part[0], b.part[0], c.part[0]), fused(a.part[1], b.part[1], c.part[1]),
             fused(a.part[2], b.part[2], c.part[2]), fused(a.part[3], b.part[3], c.part[3])}};
}
/// c - a b
HWY_INLINE Float16 fusedAway(Float16 a, Float16 b, Float16 c) {
    return fused(-a, b, c);
}
#else
HWY_INLINE Float4 fused(Float4 a, Float4 b, Float4 c) {
    return {one::MulAdd(a.lane, b.lane, c.lane)};
}
#if HWY_TARGET == HWY_AVX2
HWY_INLINE Float16 fused(Float16 a, Float16 b, Float16 c) {
    return {one::MulAdd(a.low, b.low, c.low), one::MulAdd(a.high, b.high, c.high)};
}
HWY_INLINE Float16 fusedAway(Float16 a, Float16 b, Float16 c) {
    return {one::NegMulAdd(a.low, b.low, c.low), one::NegMulAdd(a.high, b.high, c.high)};
}
#else
HWY_INLINE Float16 fused(Float16 a, Float16 b, Float16 c) {
    return {one::MulAdd(a.all, b.all, c.all)};
}
HWY_INLINE Float16 fusedAway(Float16 a, Float16 b, Float16 c) {
    return {one::NegMulAdd(a.all, b.all, c.all)};
}
#endif
#endif

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
