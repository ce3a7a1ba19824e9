// The one wide type: sixteen floats and sixteen truth values, with the same bytes on AVX-512 (one register), AVX2 (two)
// and the scalar twin (plain C++). A kernel is written once with it and compiled three times.
//
// Every operation is one IEEE operation per lane, so results agree bit for bit as long as the build forbids the
// contraction of a * b + c (-ffp-contract=off). There is no reciprocal approximation, no sum across lanes, and no fused
// multiply-add (the estimate has one of its own, in adb/detail/fused.hpp).
//
// How to write a kernel, in a file my_kernel.cpp that is compiled once per instruction set:
//
//     #include <grapeshot/adb/detail/my_kernel.hpp>          // own header: plain declarations
//     #include <grapeshot/core/detail/wide_targets.hpp>      // before anything of Highway
//     #undef HWY_TARGET_INCLUDE
//     #define HWY_TARGET_INCLUDE <grapeshot/adb/detail/my_kernel.cpp>   // this file
//     #include <hwy/foreach_target.h>                        // compiles what stands below for the other targets
//     #include <grapeshot/core/detail/wide.hpp>              // after it; includes hwy/highway.h
//
//     HWY_BEFORE_NAMESPACE();
//     namespace grapeshot::detail::HWY_NAMESPACE {
//     void addAll(const float* a, const float* b, float* sum) {   // plain types at the border
//         store(load(a) + load(b), sum);
//     }
//     }  // namespace grapeshot::detail::HWY_NAMESPACE
//     HWY_AFTER_NAMESPACE();
//
//     #if HWY_ONCE                                           // once, after all targets
//     #include <grapeshot/core/detail/kernel_table.hpp>      // has #pragma once: may also stand at the top
//     namespace grapeshot::detail {
//     void addAll(const float* a, const float* b, float* sum) {
//         static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(addAll);
//         kernel.chosen()(a, b, sum);
//     }
//     }  // namespace grapeshot::detail
//     #endif
//
// Hazards: what stands between BEFORE and AFTER must not use inline functions of other headers (Eigen, <algorithm>)
// that might be shared with the rest of the program: the copy compiled for AVX-512 could be the one the linker keeps.
// Helpers go into HWY_NAMESPACE and are HWY_INLINE. Lambdas there need HWY_ATTR; better write functions.
//
// No #pragma once: it is included once per target; the toggle is Highway's idiom.
#if defined(GRAPESHOT_CORE_DETAIL_WIDE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_WIDE_HPP
#undef GRAPESHOT_CORE_DETAIL_WIDE_HPP
#else
#define GRAPESHOT_CORE_DETAIL_WIDE_HPP
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

// Plain C++ in the vector notation of GCC and Clang, lane by lane by definition; a loop over sixteen lanes instead
// keeps the compiler busy for minutes.
using Lanes = float __attribute__((vector_size(16)));
using LanesMask = std::int32_t __attribute__((vector_size(16)));  // 0 or -1

struct Float16 {
    Lanes part[4];
};
struct Mask16 {
    LanesMask part[4];
};

// Named as in Highway. NOLINTBEGIN(readability-identifier-naming)
namespace one {
HWY_INLINE Lanes Add(Lanes a, Lanes b) {
    return a + b;
}
HWY_INLINE Lanes Sub(Lanes a, Lanes b) {
    return a - b;
}
HWY_INLINE Lanes Mul(Lanes a, Lanes b) {
    return a * b;
}
HWY_INLINE Lanes Div(Lanes a, Lanes b) {
    return a / b;
}
HWY_INLINE Lanes Min(Lanes a, Lanes b) {
    return a < b ? a : b;
}
HWY_INLINE Lanes Max(Lanes a, Lanes b) {
    return a > b ? a : b;
}
HWY_INLINE Lanes Abs(Lanes a) {
    return __builtin_bit_cast(Lanes, __builtin_bit_cast(LanesMask, a) & 0x7fffffff);
}
HWY_INLINE Lanes Neg(Lanes a) {
    return -a;
}
HWY_INLINE Lanes Sqrt(Lanes a) {
    return Lanes{__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]), __builtin_sqrtf(a[3])};
}
HWY_INLINE LanesMask Lt(Lanes a, Lanes b) {
    return a < b;
}
HWY_INLINE LanesMask Le(Lanes a, Lanes b) {
    return a <= b;
}
HWY_INLINE LanesMask Gt(Lanes a, Lanes b) {
    return a > b;
}
HWY_INLINE LanesMask Ge(Lanes a, Lanes b) {
    return a >= b;
}
HWY_INLINE LanesMask Eq(Lanes a, Lanes b) {
    return a == b;
}
HWY_INLINE LanesMask And(LanesMask a, LanesMask b) {
    return a & b;
}
HWY_INLINE LanesMask Or(LanesMask a, LanesMask b) {
    return a | b;
}
HWY_INLINE LanesMask Xor(LanesMask a, LanesMask b) {
    return a ^ b;
}
HWY_INLINE LanesMask AndNot(LanesMask a, LanesMask b) {
    return ~a & b;
}
HWY_INLINE LanesMask Not(LanesMask a) {
    return ~a;
}
HWY_INLINE Lanes IfThenElse(LanesMask mask, Lanes yes, Lanes no) {
    return mask ? yes : no;
}
}  // namespace one
// NOLINTEND(readability-identifier-naming)

#define GRAPESHOT_WIDE_1(Result, function, A, operation)                                                   \
    HWY_INLINE Result function(A a) {                                                                      \
        return {{operation(a.part[0]), operation(a.part[1]), operation(a.part[2]), operation(a.part[3])}}; \
    }
#define GRAPESHOT_WIDE_2(Result, function, A, B, operation)                                                         \
    HWY_INLINE Result function(A a, B b) {                                                                          \
        return {{operation(a.part[0], b.part[0]), operation(a.part[1], b.part[1]), operation(a.part[2], b.part[2]), \
                 operation(a.part[3], b.part[3])}};                                                                 \
    }
#define GRAPESHOT_WIDE_3(Result, function, A, B, C, operation)                                             \
    HWY_INLINE Result function(A a, B b, C c) {                                                            \
        return {{operation(a.part[0], b.part[0], c.part[0]), operation(a.part[1], b.part[1], c.part[1]),   \
                 operation(a.part[2], b.part[2], c.part[2]), operation(a.part[3], b.part[3], c.part[3])}}; \
    }

#else

namespace one = hwy::HWY_NAMESPACE;
using Register = one::ScalableTag<float>;
using RegisterInt = one::RebindToSigned<Register>;
using RegisterFloats = one::Vec<Register>;
using RegisterMask = one::Mask<Register>;

#if HWY_TARGET == HWY_AVX2
static_assert(one::MaxLanes(Register()) == 8);
struct Float16 {
    RegisterFloats low, high;
};
struct Mask16 {
    RegisterMask low, high;
};
#define GRAPESHOT_WIDE_1(Result, function, A, operation) \
    HWY_INLINE Result function(A a) {                    \
        return {operation(a.low), operation(a.high)};    \
    }
#define GRAPESHOT_WIDE_2(Result, function, A, B, operation)          \
    HWY_INLINE Result function(A a, B b) {                           \
        return {operation(a.low, b.low), operation(a.high, b.high)}; \
    }
#define GRAPESHOT_WIDE_3(Result, function, A, B, C, operation)                      \
    HWY_INLINE Result function(A a, B b, C c) {                                     \
        return {operation(a.low, b.low, c.low), operation(a.high, b.high, c.high)}; \
    }
#else
static_assert(one::MaxLanes(Register()) == 16);
struct Float16 {
    RegisterFloats all;
};
struct Mask16 {
    RegisterMask all;
};
#define GRAPESHOT_WIDE_1(Result, function, A, operation) \
    HWY_INLINE Result function(A a) {                    \
        return {operation(a.all)};                       \
    }
#define GRAPESHOT_WIDE_2(Result, function, A, B, operation) \
    HWY_INLINE Result function(A a, B b) {                  \
        return {operation(a.all, b.all)};                   \
    }
#define GRAPESHOT_WIDE_3(Result, function, A, B, C, operation) \
    HWY_INLINE Result function(A a, B b, C c) {                \
        return {operation(a.all, b.all, c.all)};               \
    }
#endif

#endif

GRAPESHOT_WIDE_2(Float16, operator+, Float16, Float16, one::Add)
GRAPESHOT_WIDE_2(Float16, operator-, Float16, Float16, one::Sub)
GRAPESHOT_WIDE_2(Float16, operator*, Float16, Float16, one::Mul)
GRAPESHOT_WIDE_2(Float16, operator/, Float16, Float16, one::Div)
GRAPESHOT_WIDE_1(Float16, operator-, Float16, one::Neg)  // flips the sign bit, of zero too
GRAPESHOT_WIDE_1(Float16, abs, Float16, one::Abs)        // clears the sign bit
GRAPESHOT_WIDE_1(Float16, sqrt, Float16, one::Sqrt)      // correctly rounded
// As x86 has them: a < b ? a : b and a > b ? a : b. So equal or unordered operands (NaN, +0 and -0) give b.
GRAPESHOT_WIDE_2(Float16, min, Float16, Float16, one::Min)
GRAPESHOT_WIDE_2(Float16, max, Float16, Float16, one::Max)

// False if an operand is NaN.
GRAPESHOT_WIDE_2(Mask16, operator<, Float16, Float16, one::Lt)
GRAPESHOT_WIDE_2(Mask16, operator<=, Float16, Float16, one::Le)
GRAPESHOT_WIDE_2(Mask16, operator>, Float16, Float16, one::Gt)
GRAPESHOT_WIDE_2(Mask16, operator>=, Float16, Float16, one::Ge)
GRAPESHOT_WIDE_2(Mask16, operator==, Float16, Float16, one::Eq)

GRAPESHOT_WIDE_2(Mask16, operator&, Mask16, Mask16, one::And)
GRAPESHOT_WIDE_2(Mask16, operator|, Mask16, Mask16, one::Or)
GRAPESHOT_WIDE_2(Mask16, operator^, Mask16, Mask16, one::Xor)
GRAPESHOT_WIDE_1(Mask16, operator!, Mask16, one::Not)
GRAPESHOT_WIDE_2(Mask16, andNot, Mask16, Mask16, one::AndNot)  // !a & b

GRAPESHOT_WIDE_3(Float16, select, Mask16, Float16, Float16, one::IfThenElse)  // mask ? yes : no

#undef GRAPESHOT_WIDE_1
#undef GRAPESHOT_WIDE_2
#undef GRAPESHOT_WIDE_3

#if HWY_TARGET != HWY_SCALAR
HWY_INLINE RegisterFloats leastOfFours(RegisterFloats a) {
    const RegisterFloats pairs = one::Min(a, one::Shuffle2301(a));
    return one::Min(pairs, one::Shuffle1032(pairs));
}
HWY_INLINE RegisterFloats mostOfFours(RegisterFloats a) {
    const RegisterFloats pairs = one::Max(a, one::Shuffle2301(a));
    return one::Max(pairs, one::Shuffle1032(pairs));
}
#endif

// wide(x): all lanes x. load/store: 16 floats, aligned to 64 bytes; the U variants: any address. spreadA: lane i =
// p[i / 4]; repeatB: lane i = p[i % 4] (four floats at any address): together all 4 x 4 combinations, lane = 4 a + b.
// leastOfFours, mostOfFours: in each lane the least (most) of the lanes 4 k to 4 k + 3 that it is one of; no NaN.
// storeInt: to 16 int32 (aligned to 64 bytes), truncated; values must fit.
#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Float16 wide(float x) {
    const Lanes all = {x, x, x, x};
    return {{all, all, all, all}};
}
HWY_INLINE Float16 loadU(const float* p) {
    Float16 result;
    std::memcpy(&result, p, sizeof(result));
    return result;
}
HWY_INLINE Float16 load(const float* p) {
    return loadU(p);
}
HWY_INLINE void storeU(Float16 a, float* p) {
    std::memcpy(p, &a, sizeof(a));
}
HWY_INLINE void store(Float16 a, float* p) {
    storeU(a, p);
}
HWY_INLINE void storeInt(Float16 a, std::int32_t* p) {
    for (int i = 0; i < 16; ++i) {
        p[i] = static_cast<std::int32_t>(a.part[i / 4][i % 4]);
    }
}
HWY_INLINE Float16 spreadA(const float* p) {
    return {{Lanes{p[0], p[0], p[0], p[0]}, Lanes{p[1], p[1], p[1], p[1]}, Lanes{p[2], p[2], p[2], p[2]},
             Lanes{p[3], p[3], p[3], p[3]}}};
}
HWY_INLINE Float16 repeatB(const float* p) {
    const Lanes four = {p[0], p[1], p[2], p[3]};
    return {{four, four, four, four}};
}
HWY_INLINE Float16 leastOfFours(Float16 a) {
    Float16 result;
    for (int i = 0; i < 4; ++i) {
        const Lanes& from = a.part[i];
        const Lanes pairs = one::Min(from, Lanes{from[1], from[0], from[3], from[2]});
        result.part[i] = one::Min(pairs, Lanes{pairs[2], pairs[3], pairs[0], pairs[1]});
    }
    return result;
}
HWY_INLINE Float16 mostOfFours(Float16 a) {
    Float16 result;
    for (int i = 0; i < 4; ++i) {
        const Lanes& from = a.part[i];
        const Lanes pairs = one::Max(from, Lanes{from[1], from[0], from[3], from[2]});
        result.part[i] = one::Max(pairs, Lanes{pairs[2], pairs[3], pairs[0], pairs[1]});
    }
    return result;
}
/// Bit i = lane i.
HWY_INLINE std::uint32_t bits(Mask16 a) {
    std::uint32_t result = 0;
    for (int i = 0; i < 16; ++i) {
        result |= (static_cast<std::uint32_t>(a.part[i / 4][i % 4]) & 1U) << static_cast<unsigned>(i);
    }
    return result;
}

/// The other way round.
HWY_INLINE Mask16 maskOf(std::uint32_t lanes) {
    Mask16 result;
    for (unsigned i = 0; i < 16; ++i) {
        result.part[i / 4][i % 4] = -static_cast<std::int32_t>(lanes >> i & 1U);
    }
    return result;
}

#elif HWY_TARGET == HWY_AVX2

HWY_INLINE Float16 leastOfFours(Float16 a) {
    return {leastOfFours(a.low), leastOfFours(a.high)};
}
HWY_INLINE Float16 mostOfFours(Float16 a) {
    return {mostOfFours(a.low), mostOfFours(a.high)};
}
HWY_INLINE Float16 wide(float x) {
    const RegisterFloats all = one::Set(Register(), x);
    return {all, all};
}
HWY_INLINE Float16 loadU(const float* p) {
    return {one::LoadU(Register(), p), one::LoadU(Register(), p + 8)};
}
HWY_INLINE Float16 load(const float* p) {
    return {one::Load(Register(), p), one::Load(Register(), p + 8)};
}
HWY_INLINE void storeU(Float16 a, float* p) {
    one::StoreU(a.low, Register(), p);
    one::StoreU(a.high, Register(), p + 8);
}
HWY_INLINE void store(Float16 a, float* p) {
    one::Store(a.low, Register(), p);
    one::Store(a.high, Register(), p + 8);
}
HWY_INLINE void storeInt(Float16 a, std::int32_t* p) {
    one::Store(one::ConvertTo(RegisterInt(), a.low), RegisterInt(), p);
    one::Store(one::ConvertTo(RegisterInt(), a.high), RegisterInt(), p + 8);
}
HWY_INLINE Float16 spreadA(const float* p) {
    alignas(32) static constexpr std::int32_t first[8] = {0, 0, 0, 0, 1, 1, 1, 1};
    alignas(32) static constexpr std::int32_t second[8] = {2, 2, 2, 2, 3, 3, 3, 3};
    const RegisterFloats four = one::LoadDup128(Register(), p);
    return {one::TableLookupLanes(four, one::SetTableIndices(Register(), first)),
            one::TableLookupLanes(four, one::SetTableIndices(Register(), second))};
}
HWY_INLINE Float16 repeatB(const float* p) {
    const RegisterFloats four = one::LoadDup128(Register(), p);
    return {four, four};
}
/// Bit i = lane i.
HWY_INLINE std::uint32_t bits(Mask16 a) {
    std::uint8_t low = 0;
    std::uint8_t high = 0;
    one::StoreMaskBits(Register(), a.low, &low);
    one::StoreMaskBits(Register(), a.high, &high);
    return static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 8U;
}
/// The other way round.
HWY_INLINE Mask16 maskOf(std::uint32_t lanes) {
    const std::uint8_t bytes[2] = {static_cast<std::uint8_t>(lanes), static_cast<std::uint8_t>(lanes >> 8U)};
    return {one::LoadMaskBits(Register(), bytes), one::LoadMaskBits(Register(), bytes + 1)};
}

#else

HWY_INLINE Float16 leastOfFours(Float16 a) {
    return {leastOfFours(a.all)};
}
HWY_INLINE Float16 mostOfFours(Float16 a) {
    return {mostOfFours(a.all)};
}
HWY_INLINE Float16 wide(float x) {
    return {one::Set(Register(), x)};
}
HWY_INLINE Float16 loadU(const float* p) {
    return {one::LoadU(Register(), p)};
}
HWY_INLINE Float16 load(const float* p) {
    return {one::Load(Register(), p)};
}
HWY_INLINE void storeU(Float16 a, float* p) {
    one::StoreU(a.all, Register(), p);
}
HWY_INLINE void store(Float16 a, float* p) {
    one::Store(a.all, Register(), p);
}
HWY_INLINE void storeInt(Float16 a, std::int32_t* p) {
    one::Store(one::ConvertTo(RegisterInt(), a.all), RegisterInt(), p);
}
HWY_INLINE Float16 spreadA(const float* p) {
    alignas(64) static constexpr std::int32_t quarter[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    return {one::TableLookupLanes(one::LoadDup128(Register(), p), one::SetTableIndices(Register(), quarter))};
}
HWY_INLINE Float16 repeatB(const float* p) {
    return {one::LoadDup128(Register(), p)};
}
/// Bit i = lane i.
HWY_INLINE std::uint32_t bits(Mask16 a) {
    std::uint8_t bytes[2] = {0, 0};
    one::StoreMaskBits(Register(), a.all, bytes);
    std::uint16_t result = 0;
    std::memcpy(&result, bytes, sizeof(result));
    return result;
}
/// The other way round.
HWY_INLINE Mask16 maskOf(std::uint32_t lanes) {
    std::uint8_t bytes[sizeof(lanes)];
    std::memcpy(bytes, &lanes, sizeof(lanes));
    return {one::LoadMaskBits(Register(), bytes)};
}

#endif

HWY_INLINE Mask16 noLane() {
    return wide(0) < wide(0);
}
HWY_INLINE Mask16 allLanes() {
    return wide(0) <= wide(0);
}
HWY_INLINE bool any(Mask16 a) {
    return bits(a) != 0U;
}

/// The largest power of two that is not above a (a normal, positive, finite): scaling by it and by its reciprocal is
/// exact.
HWY_INLINE Float16 powerOfTwoBelow(Float16 a) {
#if HWY_TARGET == HWY_SCALAR
    Float16 result;
    for (int i = 0; i < 4; ++i) {
        result.part[i] = __builtin_bit_cast(Lanes, __builtin_bit_cast(LanesMask, a.part[i]) & 0x7f800000);
    }
    return result;
#else
    const RegisterFloats exponent = one::BitCast(Register(), one::Set(RegisterInt(), 0x7f800000));
#if HWY_TARGET == HWY_AVX2
    return {one::And(a.low, exponent), one::And(a.high, exponent)};
#else
    return {one::And(a.all, exponent)};
#endif
#endif
}

/// Sixteen points or vectors.
struct Vector16 {
    Float16 x, y, z;
};
HWY_INLINE Vector16 operator+(Vector16 a, Vector16 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vector16 operator-(Vector16 a, Vector16 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Vector16 operator*(Vector16 a, Float16 s) {
    return {a.x * s, a.y * s, a.z * s};
}
HWY_INLINE Vector16 operator-(Vector16 a) {
    return {-a.x, -a.y, -a.z};
}
HWY_INLINE Float16 dot(Vector16 a, Vector16 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vector16 cross(Vector16 a, Vector16 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE Vector16 select(Mask16 mask, Vector16 yes, Vector16 no) {
    return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
