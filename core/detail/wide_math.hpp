// Sums, largest lanes, and rough powers and logarithms of sixteen floats: the same bytes on every instruction set.
//
// This work is based on:
// Nicol Schraudolph. A Fast, Compact Approximation of the Exponential Function. Neural Computation 11(4), 1999 (the
// bits of a float, taken for a number, are its logarithm to base 2, linear between powers of two)
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_CORE_DETAIL_WIDE_MATH_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_WIDE_MATH_HPP
#undef GRAPESHOT_CORE_DETAIL_WIDE_MATH_HPP
#else
#define GRAPESHOT_CORE_DETAIL_WIDE_MATH_HPP
#endif

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Lanes bitsAsNumber(Lanes a) {
    return __builtin_convertvector(__builtin_bit_cast(LanesMask, a), Lanes);
}
HWY_INLINE Lanes numberAsBits(Lanes a) {
    return __builtin_bit_cast(Lanes, __builtin_convertvector(a, LanesMask));
}
#define GRAPESHOT_WIDE_BITS(function)                                                                  \
    HWY_INLINE Float16 function(Float16 a) {                                                           \
        return {{function(a.part[0]), function(a.part[1]), function(a.part[2]), function(a.part[3])}}; \
    }
#else
HWY_INLINE RegisterFloats bitsAsNumber(RegisterFloats a) {
    return one::ConvertTo(Register(), one::BitCast(RegisterInt(), a));
}
HWY_INLINE RegisterFloats numberAsBits(RegisterFloats a) {
    return one::BitCast(Register(), one::ConvertTo(RegisterInt(), a));
}
#if HWY_TARGET == HWY_AVX2
#define GRAPESHOT_WIDE_BITS(function)               \
    HWY_INLINE Float16 function(Float16 a) {        \
        return {function(a.low), function(a.high)}; \
    }
#else
#define GRAPESHOT_WIDE_BITS(function)        \
    HWY_INLINE Float16 function(Float16 a) { \
        return {function(a.all)};            \
    }
#endif
#endif
GRAPESHOT_WIDE_BITS(bitsAsNumber)  // the bits as a whole number, rounded to a float
GRAPESHOT_WIDE_BITS(numberAsBits)  // the other way round, truncated; must be within the range of an int32
#undef GRAPESHOT_WIDE_BITS

/// Of positive, finite, normal numbers; up to 0.086 too small.
HWY_INLINE Float16 roughLog2(Float16 a) {
    return bitsAsNumber(a) * wide(0x1p-23F) - wide(127);
}

/// Up to 6.2 % too large, steadily increasing. Arguments beyond +-120 count as +-120, NaN as -120.
HWY_INLINE Float16 roughExp2(Float16 a) {
    return numberAsBits(min(max(a, wide(-120)), wide(120)) * wide(0x1p23F) + wide(0x1p23F * 127));
}

// Sum and largest of all lanes, in the order of a tournament: lane i with lane i + 8, then + 4, + 2, + 1. NaN: the sum
// is NaN, the largest anything.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE float sum(Float16 a) {
    const Lanes four = (a.part[0] + a.part[2]) + (a.part[1] + a.part[3]);
    return (four[0] + four[2]) + (four[1] + four[3]);
}
HWY_INLINE float largestLane(Float16 a) {
    const Lanes four = one::Max(one::Max(a.part[0], a.part[2]), one::Max(a.part[1], a.part[3]));
    const float even = four[0] > four[2] ? four[0] : four[2];
    const float odd = four[1] > four[3] ? four[1] : four[3];
    return even > odd ? even : odd;
}
#else
using Register8 = one::FixedTag<float, 8>;
using Register4 = one::FixedTag<float, 4>;
#if HWY_TARGET == HWY_AVX2
HWY_INLINE one::Vec<Register8> lowEight(Float16 a) {
    return a.low;
}
HWY_INLINE one::Vec<Register8> highEight(Float16 a) {
    return a.high;
}
#else
HWY_INLINE one::Vec<Register8> lowEight(Float16 a) {
    return one::LowerHalf(Register8(), a.all);
}
HWY_INLINE one::Vec<Register8> highEight(Float16 a) {
    return one::UpperHalf(Register8(), a.all);
}
#endif
HWY_INLINE float sum(Float16 a) {
    const auto eight = one::Add(lowEight(a), highEight(a));
    const auto four = one::Add(one::LowerHalf(Register4(), eight), one::UpperHalf(Register4(), eight));
    const auto two = one::Add(four, one::Shuffle1032(four));
    return one::GetLane(one::Add(two, one::Shuffle2301(two)));
}
HWY_INLINE float largestLane(Float16 a) {
    const auto eight = one::Max(lowEight(a), highEight(a));
    const auto four = one::Max(one::LowerHalf(Register4(), eight), one::UpperHalf(Register4(), eight));
    const auto two = one::Max(four, one::Shuffle1032(four));
    return one::GetLane(one::Max(two, one::Shuffle2301(two)));
}
#endif

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
