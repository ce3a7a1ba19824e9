// What a step does to the cut: take the likeliest out, put its children in.
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_CUT_WIDE_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_CUT_WIDE_HPP
#undef GRAPESHOT_ADB_DETAIL_CUT_WIDE_HPP
#else
#define GRAPESHOT_ADB_DETAIL_CUT_WIDE_HPP
#endif

#include <grapeshot/adb/detail/child_sides.hpp>
#include <grapeshot/adb/detail/estimate.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Every fourth block clears those behind it, where another query may have been.
HWY_INLINE void clearFrom(Cut& cut, std::size_t block) {
    for (; block % 4 != 0; ++block) {
        store(wide(0), cut.rates + 16 * block);
    }
}

/// Moves the entries together, in their order.
HWY_INLINE void compact(Cut& cut) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < 16 * cut.blocks; i += 16) {
        const Float16 rates = load(cut.rates + i);
        const std::uint32_t mask = bits(rates > wide(0));
        writeLanes(rates, mask, cut.rates + count);
        writeLanes(cut.sidesA + i, mask, cut.sidesA + count);
        count += writeLanes(cut.sidesB + i, mask, cut.sidesB + count);
    }
    alignas(64) float last[16];
    const std::size_t full = count / 16 * 16;
    store(load(cut.rates + full), last);
    for (std::size_t i = count - full; i < 16; ++i) {
        last[i] = 0;
    }
    store(load(last), cut.rates + full);
    cut.blocks = (count + 15) / 16;
    clearFrom(cut, full / 16 + 1);
}

/// Puts the lanes of the mask in. `rates` is 0 in the others, and greater in these.
HWY_INLINE void append(Cut& cut, const FourSides& a, const FourSides& b, Float16 rates, std::uint32_t mask) {
    if (mask == 0) {
        return;
    }
    if (cut.blocks == mostBlocks) [[unlikely]] {
        compact(cut);
    }
    const std::size_t place = 16 * cut.blocks++;
    store(rates, cut.rates + place);
    storeSides(a, b, cut.sidesA + place, cut.sidesB + place);
    if (cut.blocks % 4 == 1) {
        clearFrom(cut, cut.blocks);
    }
    cut.count += static_cast<std::size_t>(__builtin_popcount(mask));
}

/// Takes the entry with the largest rate (of equal ones the first) out. There must be one.
HWY_INLINE SidePair takeLargest(Cut& cut) {
    Float16 largest = load(cut.rates);
    for (std::size_t i = 1; i < cut.blocks; ++i) {
        largest = max(largest, load(cut.rates + 16 * i));
    }
    const float rate = largestLane(largest);
    // Four blocks at a time: which of them it is cannot be foreseen.
    std::uint64_t lanes = 0;
    std::size_t first = 0;
    for (;; first += 64) {
        for (std::size_t i = 0; i < 4; ++i) {
            lanes |= std::uint64_t{bits(load(cut.rates + first + 16 * i) == wide(rate))} << (16 * i);
        }
        if (lanes != 0 || first + 64 >= 16 * cut.blocks) {
            break;
        }
    }
    const std::size_t place = first + static_cast<std::size_t>(__builtin_ctzll(lanes));
    cut.rates[place] = 0;
    --cut.count;
    cut.rate = cut.count == 0 || cut.rate < rate ? 0 : cut.rate - rate;
    return sidePair(cut.sidesA[place], cut.sidesB[place]);
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
