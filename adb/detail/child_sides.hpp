// From the lanes of a tested pair to the pairs of children that they stand for.
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_CHILD_SIDES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_CHILD_SIDES_HPP
#undef GRAPESHOT_ADB_DETAIL_CHILD_SIDES_HPP
#else
#define GRAPESHOT_ADB_DETAIL_CHILD_SIDES_HPP
#endif

#include <grapeshot/adb/detail/descent.hpp>
#include <grapeshot/adb/detail/node_pair.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// The four sides below a side, or a leaf four times.
struct FourSides {
    alignas(16) Side side[4];
};
HWY_INLINE FourSides sidesOf(const Node* nodes, Side side) {
    using FourInts = std::int32_t __attribute__((vector_size(16)));
    FourSides out;
    if (isLeaf(side)) {
        const auto leaf = static_cast<std::int32_t>(side);
        const FourInts same = {leaf, leaf, leaf, leaf};
        std::memcpy(out.side, &same, sizeof(same));
        return out;
    }
    FourInts children;
    std::memcpy(&children, nodes[side].child, sizeof(children));
    const FourInts slots = static_cast<std::int32_t>(leafBit | side << 2U) + FourInts{0, 1, 2, 3};
    const FourInts sides = children < 0 ? slots : children;  // negative: the bit of a leaf
    std::memcpy(out.side, &sides, sizeof(sides));
    return out;
}

/// Calls run(a, b) with what the kernels take for the children of each side, and returns the lanes that mean something:
/// all, or one for each child of the one inner side. Not for two leaves.
template <typename Run>
HWY_INLINE std::uint32_t withChildren(const Descent& descent, Side a, Side b, const Run& run) {
    const auto all = [](const auto* nodes, Side side) HWY_ATTR { return nodes + side; };
    const auto parent = [](const auto* nodes, Side side) HWY_ATTR { return nodes + (indexOf(side) >> 2U); };
    if (!isLeaf(a) && !isLeaf(b)) [[likely]] {
        run(AllOfA{all(descent.nodesA, a), all(descent.distributionsA, a)},
            AllOfB{all(descent.nodesB, b), all(descent.distributionsB, b)});
        return 0xffffU;
    }
    if (isLeaf(a)) {
        run(OneChild{parent(descent.nodesA, a), parent(descent.distributionsA, a), a & 3U},
            AllOfB{all(descent.nodesB, b), all(descent.distributionsB, b)});
        return 0x000fU;
    }
    run(AllOfA{all(descent.nodesA, a), all(descent.distributionsA, a)},
        OneChild{parent(descent.nodesB, b), parent(descent.distributionsB, b), b & 3U});
    return 0x1111U;
}

/// Writes the sides of the lanes of the mask to outA and outB, in the order of the lanes. Returns how many. Up to
/// sixteen entries from the first on are overwritten, those behind the last with anything.
HWY_INLINE std::size_t writeLanes(const FourSides& a, const FourSides& b, std::uint32_t mask, Side* outA, Side* outB) {
#if HWY_TARGET == HWY_SCALAR
    std::size_t count = 0;
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        outA[count] = a.side[lane >> 2U];
        outB[count] = b.side[lane & 3U];
        ++count;
    }
    return count;
#else
    const auto* const fourA = reinterpret_cast<const float*>(a.side);
    const auto* const fourB = reinterpret_cast<const float*>(b.side);
    const Float16 allA = spreadA(fourA);
    const Float16 allB = repeatB(fourB);
    const Mask16 lanes = maskOf(mask);
    auto* const floatsA = reinterpret_cast<float*>(outA);
    auto* const floatsB = reinterpret_cast<float*>(outB);
#if HWY_TARGET == HWY_AVX2
    const auto low = static_cast<std::size_t>(__builtin_popcount(mask & 0xffU));
    one::StoreU(one::Compress(allA.low, lanes.low), Register(), floatsA);
    one::StoreU(one::Compress(allA.high, lanes.high), Register(), floatsA + low);
    one::StoreU(one::Compress(allB.low, lanes.low), Register(), floatsB);
    one::StoreU(one::Compress(allB.high, lanes.high), Register(), floatsB + low);
#else
    one::StoreU(one::Compress(allA.all, lanes.all), Register(), floatsA);
    one::StoreU(one::Compress(allB.all, lanes.all), Register(), floatsB);
#endif
    return static_cast<std::size_t>(__builtin_popcount(mask));
#endif
}

/// All sixteen lanes.
HWY_INLINE void storeSides(const FourSides& a, const FourSides& b, Side* outA, Side* outB) {
#if HWY_TARGET == HWY_SCALAR
    for (std::uint32_t lane = 0; lane < 16; ++lane) {
        outA[lane] = a.side[lane >> 2U];
        outB[lane] = b.side[lane & 3U];
    }
#else
    storeU(spreadA(reinterpret_cast<const float*>(a.side)), reinterpret_cast<float*>(outA));
    storeU(repeatB(reinterpret_cast<const float*>(b.side)), reinterpret_cast<float*>(outB));
#endif
}

/// The same for one number per lane.
HWY_INLINE void writeLanes(Float16 numbers, std::uint32_t mask, float* out) {
#if HWY_TARGET == HWY_SCALAR
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        *out++ = numbers.part[lane / 4][lane % 4];
    }
#else
    const Mask16 lanes = maskOf(mask);
#if HWY_TARGET == HWY_AVX2
    one::StoreU(one::Compress(numbers.low, lanes.low), Register(), out);
    one::StoreU(one::Compress(numbers.high, lanes.high), Register(), out + __builtin_popcount(mask & 0xffU));
#else
    one::StoreU(one::Compress(numbers.all, lanes.all), Register(), out);
#endif
#endif
}

/// The same for sides that stand in their lanes. `out` may be at `in` or before it.
HWY_INLINE std::size_t writeLanes(const Side* in, std::uint32_t mask, Side* out) {
#if HWY_TARGET == HWY_SCALAR
    std::size_t count = 0;
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
        out[count++] = in[__builtin_ctz(rest)];
    }
    return count;
#else
    writeLanes(loadU(reinterpret_cast<const float*>(in)), mask, reinterpret_cast<float*>(out));
    return static_cast<std::size_t>(__builtin_popcount(mask));
#endif
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
