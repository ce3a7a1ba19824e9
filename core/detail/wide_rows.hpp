// Records of floats that lie anywhere, sixteen at a time: from one lane's numbers beside each other to one number of
// all lanes, in registers. (What was stored float by float cannot be loaded at once without waiting for it.)
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_CORE_DETAIL_WIDE_ROWS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_CORE_DETAIL_WIDE_ROWS_HPP
#undef GRAPESHOT_CORE_DETAIL_WIDE_ROWS_HPP
#else
#define GRAPESHOT_CORE_DETAIL_WIDE_ROWS_HPP
#endif

#include <grapeshot/core/detail/wide_math.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
/// Of four registers the transposed fours: in each block of four lanes, lane i of row r goes to lane r of row i.
HWY_INLINE void transposeFours(const RegisterFloats (&in)[4], RegisterFloats (&out)[4]) {
    const one::Repartition<double, Register> pairs;
    const auto asPairs = [&](RegisterFloats a) HWY_ATTR { return one::BitCast(pairs, a); };
    const auto low01 = asPairs(one::InterleaveLower(Register(), in[0], in[1]));
    const auto low23 = asPairs(one::InterleaveLower(Register(), in[2], in[3]));
    const auto high01 = asPairs(one::InterleaveUpper(Register(), in[0], in[1]));
    const auto high23 = asPairs(one::InterleaveUpper(Register(), in[2], in[3]));
    out[0] = one::BitCast(Register(), one::InterleaveLower(pairs, low01, low23));
    out[1] = one::BitCast(Register(), one::InterleaveUpper(pairs, low01, low23));
    out[2] = one::BitCast(Register(), one::InterleaveLower(pairs, high01, high23));
    out[3] = one::BitCast(Register(), one::InterleaveUpper(pairs, high01, high23));
}
HWY_INLINE one::Vec<Register8> twoFours(const float* low, const float* high) {
    return one::Combine(Register8(), one::LoadU(Register4(), high), one::LoadU(Register4(), low));
}
#endif

/// Lane i of rows[k] is record[i][first + k], for k of 0 to 3.
HWY_INLINE void loadFours(const float* const (&record)[16], int first, Float16* rows) {
#if HWY_TARGET == HWY_SCALAR
    for (int k = 0; k < 4; ++k) {
        for (int four = 0; four < 4; ++four) {
            rows[k].part[four] = Lanes{record[4 * four][first + k], record[4 * four + 1][first + k],
                                       record[4 * four + 2][first + k], record[4 * four + 3][first + k]};
        }
    }
#elif HWY_TARGET == HWY_AVX2
    RegisterFloats in[4];
    RegisterFloats out[4];
    for (int i = 0; i < 4; ++i) {
        in[i] = twoFours(record[i] + first, record[4 + i] + first);
    }
    transposeFours(in, out);
    for (int k = 0; k < 4; ++k) {
        rows[k].low = out[k];
    }
    for (int i = 0; i < 4; ++i) {
        in[i] = twoFours(record[8 + i] + first, record[12 + i] + first);
    }
    transposeFours(in, out);
    for (int k = 0; k < 4; ++k) {
        rows[k].high = out[k];
    }
#else
    RegisterFloats in[4];
    RegisterFloats out[4];
    for (int i = 0; i < 4; ++i) {
        in[i] = one::Combine(Register(), twoFours(record[8 + i] + first, record[12 + i] + first),
                             twoFours(record[i] + first, record[4 + i] + first));
    }
    transposeFours(in, out);
    for (int k = 0; k < 4; ++k) {
        rows[k].all = out[k];
    }
#endif
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
