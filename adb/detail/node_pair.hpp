// Sixteen boxes with slabs of one tree against those of another: the four children of a node of A times the four of a
// node of B, lane = 4 a + b.
//
// This work is based on:
// Stefan Gottschalk, Ming Lin, Dinesh Manocha. OBBTree. SIGGRAPH 1996 (separating axes; here the 6 face normals only)
//
// Included once per instruction set, after <grapeshot/core/detail/wide.hpp>; the toggle is Highway's idiom.
#if defined(GRAPESHOT_ADB_DETAIL_NODE_PAIR_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAPESHOT_ADB_DETAIL_NODE_PAIR_HPP
#undef GRAPESHOT_ADB_DETAIL_NODE_PAIR_HPP
#else
#define GRAPESHOT_ADB_DETAIL_NODE_PAIR_HPP
#endif

#include <grapeshot/adb/detail/pair_pose.hpp>
#include <grapeshot/core/detail/wide_math.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Four floats.
#if HWY_TARGET == HWY_SCALAR
struct Float4 {
    Lanes lane;
};
HWY_INLINE Float4 four(const float* p) {
    return {Lanes{p[0], p[1], p[2], p[3]}};
}
HWY_INLINE Float4 fourTimes(float x) {
    return {Lanes{x, x, x, x}};
}
HWY_INLINE Float4 abs(Float4 a) {
    return {one::Abs(a.lane)};
}
template <typename Integer>
HWY_INLINE Float4 fourNumbers(const Integer* p) {
    return {
        Lanes{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), static_cast<float>(p[3])}};
}
HWY_INLINE Float16 together(Float4 a, Float4 b, Float4 c, Float4 d) {
    return {{a.lane, b.lane, c.lane, d.lane}};
}
#else
struct Float4 {
    one::Vec<Register4> lane;
};
HWY_INLINE Float4 four(const float* p) {
    return {one::Load(Register4(), p)};
}
HWY_INLINE Float4 fourTimes(float x) {
    return {one::Set(Register4(), x)};
}
HWY_INLINE Float4 abs(Float4 a) {
    return {one::Abs(a.lane)};
}
template <typename Integer>
HWY_INLINE Float4 fourNumbers(const Integer* p) {
    const one::FixedTag<Integer, 4> integers;
    return {one::ConvertTo(Register4(), one::PromoteTo(one::FixedTag<std::int32_t, 4>(), one::LoadU(integers, p)))};
}
HWY_INLINE Float16 together(Float4 a, Float4 b, Float4 c, Float4 d) {
    const auto low = one::Combine(Register8(), b.lane, a.lane);
    const auto high = one::Combine(Register8(), d.lane, c.lane);
#if HWY_TARGET == HWY_AVX2
    return {low, high};
#else
    return {one::Combine(Register(), high, low)};
#endif
}
#endif

/// Four rows of four children in one, taken apart again: repeated as B's side or spread as A's side of the sixteen.
/// From a register in one shuffle where there is one.
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_AVX2
struct Quarters {
    alignas(64) float lane[16];
    HWY_INLINE explicit Quarters(Float16 all) { store(all, lane); }
    HWY_INLINE Float16 repeated(int quarter) const { return repeatB(lane + 4 * quarter); }
    HWY_INLINE Float16 spread(int quarter) const { return spreadA(lane + 4 * quarter); }
};
#else
alignas(64) inline constexpr std::int32_t repeatLanes[4][16] = {
    {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3},
    {4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7},
    {8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11},
    {12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15}};
alignas(64) inline constexpr std::int32_t spreadLanes[4][16] = {
    {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3},
    {4, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6, 7, 7, 7, 7},
    {8, 8, 8, 8, 9, 9, 9, 9, 10, 10, 10, 10, 11, 11, 11, 11},
    {12, 12, 12, 12, 13, 13, 13, 13, 14, 14, 14, 14, 15, 15, 15, 15}};
struct Quarters {
    Float16 all;
    HWY_INLINE explicit Quarters(Float16 lanes) : all(lanes) {}
    HWY_INLINE Float16 repeated(int quarter) const {
        return {one::TableLookupLanes(all.all, one::SetTableIndices(Register(), repeatLanes[quarter]))};
    }
    HWY_INLINE Float16 spread(int quarter) const {
        return {one::TableLookupLanes(all.all, one::SetTableIndices(Register(), spreadLanes[quarter]))};
    }
};
#endif

/// All four children of a node, as A's or B's side of the sixteen.
struct AllOfA {
    const Node* node;
    const NodeDistribution* distribution;
    HWY_INLINE Float16 wideOf(const float* row) const { return spreadA(row); }
    HWY_INLINE Float4 fourOf(const float* row) const { return four(row); }
    template <typename Integer>
    HWY_INLINE Float4 numbersOf(const Integer* row) const {
        return fourNumbers(row);
    }
};
struct AllOfB {
    const Node* node;
    const NodeDistribution* distribution;
    HWY_INLINE Float16 wideOf(const float* row) const { return repeatB(row); }
    HWY_INLINE Float4 fourOf(const float* row) const { return four(row); }
    template <typename Integer>
    HWY_INLINE Float4 numbersOf(const Integer* row) const {
        return fourNumbers(row);
    }
};
/// One child of a node, in every lane.
struct OneChild {
    const Node* node;
    const NodeDistribution* distribution;
    std::uint32_t slot;
    HWY_INLINE Float16 wideOf(const float* row) const { return wide(row[slot]); }
    HWY_INLINE Float4 fourOf(const float* row) const { return fourTimes(row[slot]); }
    template <typename Integer>
    HWY_INLINE Float4 numbersOf(const Integer* row) const {
        return fourTimes(static_cast<float>(row[slot]));
    }
};

/// The quarters of WidePose::turn from two numbers, p[2 which] and p[2 which + 1].
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Float16 turnOf(const float* p, int which) {
    const float x = p[2 * which];
    const float y = p[2 * which + 1];
    const Lanes first = {x, x, x, x};
    const Lanes second = {y, y, y, y};
    return {{one::Abs(first), one::Abs(second), first, second}};
}
#else
HWY_INLINE Float16 turnOf(const float* p, int which) {
    alignas(64) static constexpr std::int32_t lanes[2][8] = {{0, 0, 0, 0, 1, 1, 1, 1}, {2, 2, 2, 2, 3, 3, 3, 3}};
    const auto eight =
        one::TableLookupLanes(one::LoadDup128(Register8(), p), one::SetTableIndices(Register8(), lanes[which]));
#if HWY_TARGET == HWY_AVX2
    return {one::Abs(eight), eight};
#else
    return {one::Combine(Register(), eight, one::Abs(eight))};
#endif
}
#endif

/// A prepared pose in registers.
struct WidePose {
    const PairPose* pose;
    /// Four products of a 3 x 3 matrix at once: entry (row, column) of |R|, |R^T|, R and R^T in the four quarters of
    /// the lanes. Makes B's half extents those in A's frame, A's in B's frame, B's normals in A's frame, A's in B's.
    Float16 turn[3][3];
};
HWY_INLINE WidePose widened(const PairPose& pose) {
    WidePose out;
    out.pose = &pose;
#pragma GCC unroll 3
    for (int row = 0; row < 3; ++row) {
#pragma GCC unroll 3
        for (int column = 0; column < 3; ++column) {
            out.turn[row][column] = turnOf(pose.pairs[row] + 4 * (column / 2), column % 2);
        }
    }
    return out;
}

/// By how much each pair of children overlaps along the axis where it overlaps least (negative: the gap), in metres.
/// The axes are the faces of both boxes and the normals of both slabs, so a pair with a negative margin is apart by at
/// least that much, up to rounding (see PairPose::threshold). Empty slots have a margin below -1e35.
/// @param apart from the middles of A's boxes to those of B's, in A's frame, m
template <class SideA, class SideB>
HWY_INLINE Float16 marginsOf(const WidePose& widePose, SideA a, SideB b, Float16 (&apart)[3]) {
    const PairPose& pose = *widePose.pose;
    const Node& nodeA = *a.node;
    const Node& nodeB = *b.node;

    // Half extents and normals into the other frame, four products at once. Only absolute values are needed of them.
    Float16 in[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        in[i] = together(b.fourOf(nodeB.half[i]), a.fourOf(nodeA.half[i]), b.fourOf(nodeB.normal[i]),
                         a.fourOf(nodeA.normal[i]));
    }
    const auto turned = [&](int row) HWY_ATTR {
        return Quarters(
            abs(widePose.turn[row][0] * in[0] + widePose.turn[row][1] * in[1] + widePose.turn[row][2] * in[2]));
    };
    const Quarters turned0 = turned(0);
    const Quarters turned1 = turned(1);
    const Quarters turned2 = turned(2);

    const Float16 centerB[3] = {b.wideOf(nodeB.center[0]), b.wideOf(nodeB.center[1]), b.wideOf(nodeB.center[2])};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        apart[i] = wide(pose.row[i][0]) * centerB[0] + wide(pose.row[i][1]) * centerB[1] +
                   wide(pose.row[i][2]) * centerB[2] + wide(pose.row[i][3]) - a.wideOf(nodeA.center[i]);
    }
    Float16 apartInB[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        apartInB[i] =
            wide(pose.row[0][i]) * apart[0] + wide(pose.row[1][i]) * apart[1] + wide(pose.row[2][i]) * apart[2];
    }

    const Float16 halfA[3] = {a.wideOf(nodeA.half[0]), a.wideOf(nodeA.half[1]), a.wideOf(nodeA.half[2])};
    const Float16 halfB[3] = {b.wideOf(nodeB.half[0]), b.wideOf(nodeB.half[1]), b.wideOf(nodeB.half[2])};
    Float16 margin = halfA[0] + turned0.repeated(0) - abs(apart[0]);
    margin = min(margin, halfA[1] + turned1.repeated(0) - abs(apart[1]));
    margin = min(margin, halfA[2] + turned2.repeated(0) - abs(apart[2]));
    margin = min(margin, halfB[0] + turned0.spread(1) - abs(apartInB[0]));
    margin = min(margin, halfB[1] + turned1.spread(1) - abs(apartInB[1]));
    margin = min(margin, halfB[2] + turned2.spread(1) - abs(apartInB[2]));

    const Float16 heightB = a.wideOf(nodeA.normal[0]) * apart[0] + a.wideOf(nodeA.normal[1]) * apart[1] +
                            a.wideOf(nodeA.normal[2]) * apart[2];
    const Float16 radiusB = turned0.spread(3) * halfB[0] + turned1.spread(3) * halfB[1] + turned2.spread(3) * halfB[2];
    margin = min(margin, min(a.wideOf(nodeA.slabHigh) - heightB, heightB - a.wideOf(nodeA.slabLow)) + radiusB);

    const Float16 depthA = b.wideOf(nodeB.normal[0]) * apartInB[0] + b.wideOf(nodeB.normal[1]) * apartInB[1] +
                           b.wideOf(nodeB.normal[2]) * apartInB[2];
    const Float16 radiusA =
        turned0.repeated(2) * halfA[0] + turned1.repeated(2) * halfA[1] + turned2.repeated(2) * halfA[2];
    margin = min(margin, min(b.wideOf(nodeB.slabHigh) + depthA, -depthA - b.wideOf(nodeB.slabLow)) + radiusA);
    return margin;
}

/// Not below the threshold; a NaN (coordinates near the end of the range) counts as touching.
HWY_INLINE std::uint32_t touching(const PairPose& pose, Float16 margin) {
    return bits(!(margin < wide(pose.threshold)));
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // toggle
