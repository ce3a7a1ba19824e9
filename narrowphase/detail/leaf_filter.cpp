#include <grapeshot/narrowphase/detail/leaf_filter.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/narrowphase/detail/leaf_filter.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>
#include <grapeshot/core/detail/wide_rows.hpp>

#ifndef GRAPESHOT_NARROWPHASE_DETAIL_LEAF_FILTER_ROWS
#define GRAPESHOT_NARROWPHASE_DETAIL_LEAF_FILTER_ROWS
namespace grapeshot::detail {

/// Leaves of one side, each in its mesh's frame.
struct LeafSource {
    const LeafShape* shapes;
    const LeafBlock* blocks;
};
struct LeafPose {
    float rotation[3][3];  // B's frame to A's
    float translation[3];
    float reach, rounding;
    float moreCosine, moreSine;
    float widerCosine, widerSine;  // what bounds every line, beyond the spread, at an unusual lean
    bool usual, twoSided;
};

}  // namespace grapeshot::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

/// Sixteen leaves of one side, lane by lane, each in its mesh's frame.
struct Leaves16 {
    Vector16 center, half, axis;
    Float16 cosine, sine;            // of the cone's half angle
    Float16 touchCosine, touchSine;  // of that of the lines to what touches it; cosine <= 0: it parts nothing
    std::uint32_t plain;
};
HWY_INLINE Leaves16 leavesOf(const float* const (&shape)[16], const LeafPose& pose) {
    Float16 row[16];
    for (int quarter = 0; quarter < 4; ++quarter) {
        loadFours(shape, 4 * quarter, row + 4 * quarter);
    }
    Leaves16 leaves{
        {row[0], row[1], row[2]}, {row[3], row[4], row[5]}, {row[6], row[7], row[8]}, row[9], row[10], row[11], row[12],
        bits(row[13] > wide(0))};
    if (!pose.usual) {
        const Float16 cosine = leaves.cosine * wide(pose.widerCosine) - leaves.sine * wide(pose.widerSine);
        leaves.touchSine = leaves.sine * wide(pose.widerCosine) + leaves.cosine * wide(pose.widerSine);
        leaves.touchCosine = select(leaves.cosine > wide(0), cosine, leaves.cosine);
    }
    return leaves;
}
HWY_INLINE Vector16 abs(Vector16 v) {
    return {abs(v.x), abs(v.y), abs(v.z)};
}

struct Turn {
    float r[3][3];
};
HWY_INLINE Vector16 turned(const Turn& turn, Vector16 v) {
    const auto& r = turn.r;
    return {wide(r[0][0]) * v.x + wide(r[0][1]) * v.y + wide(r[0][2]) * v.z,
            wide(r[1][0]) * v.x + wide(r[1][1]) * v.y + wide(r[1][2]) * v.z,
            wide(r[2][0]) * v.x + wide(r[2][1]) * v.y + wide(r[2][2]) * v.z};
}

/// Of boxes along the axes of one frame; squared distance is the sum of the squares of the positive ones.
struct BoxGaps {
    Float16 largest, square;
};
HWY_INLINE BoxGaps gapsOf(Vector16 offset, Vector16 halves) {
    const Vector16 gap = abs(offset) - halves;
    const Float16 zero = wide(0);
    const Vector16 open = {max(gap.x, zero), max(gap.y, zero), max(gap.z, zero)};
    return {max(max(gap.x, gap.y), gap.z), dot(open, open)};
}

/// What is asked of the corners of both leaves by one of the two cones.
struct Cone16 {
    Vector16 axis, sideways;  // unit, in the frame of the cone's leaf; `sideways` along the other leaf's offset
    Float16 length;           // of that offset, sideways
    Mask16 parts;             // not every line is within
};
HWY_INLINE Cone16 coneOf(const Leaves16& own, Vector16 offset, Float16 rounding) {
    Cone16 cone;
    cone.axis = own.axis;
    const Vector16 across = offset - cone.axis * dot(offset, cone.axis);
    cone.length = sqrt(dot(across, across));
    cone.parts = (own.touchCosine > wide(0)) & (cone.length > rounding);
    cone.sideways = across * (wide(1) / max(cone.length, wide(1e-30F)));
    return cone;
}
/// Do the boxes alone tell that all lines leave the cone? `inOther`: sideways, in the other leaf's frame.
HWY_INLINE Mask16 boxesLieBeside(const Leaves16& own, const Cone16& cone, Vector16 inOther, Vector16 otherHalf,
                                 const LeafPose& pose) {
    const Float16 halves = dot(abs(cone.sideways), own.half) + dot(abs(inOther), otherHalf);
    const Float16 most = own.touchSine * wide(pose.reach) + wide(2 * pose.rounding);
    return cone.parts & (cone.length - halves > most);
}

/// Directions of one pair in one frame: sideways and along the axis by A's cone, then by B's.
struct alignas(16) Directions {
    float component[3][4];
};
HWY_INLINE void storeDirections(const Vector16 (&directions)[4], float (&to)[4][3][16]) {
    for (int d = 0; d < 4; ++d) {
        store(directions[d].x, to[d][0]);
        store(directions[d].y, to[d][1]);
        store(directions[d].z, to[d][2]);
    }
}
HWY_INLINE Directions directionsOf(const float (&from)[4][3][16], unsigned pair) {
    Directions result;
    for (int axis = 0; axis < 3; ++axis) {
        for (int d = 0; d < 4; ++d) {
            result.component[axis][d] = from[d][axis][pair];
        }
    }
    return result;
}

/// How far a leaf's triangles reach along the four directions: in lanes 4 d to 4 d + 3.
struct Extents16 {
    Float16 low, high;
};
HWY_INLINE Extents16 extentsOf(const float (*corner)[3][4], const Directions& directions) {
    const Vector16 along = {spreadA(directions.component[0]), spreadA(directions.component[1]),
                            spreadA(directions.component[2])};
    Extents16 result;
    for (int c = 0; c < 3; ++c) {
        const Vector16 point = {repeatB(corner[c][0]), repeatB(corner[c][1]), repeatB(corner[c][2])};
        const Float16 at = dot(along, point);
        result.low = c == 0 ? at : min(result.low, at);
        result.high = c == 0 ? at : max(result.high, at);
    }
    return {leastOfFours(result.low), mostOfFours(result.high)};
}

/// One of the two cones, for one pair.
struct Touch {
    bool parts;
    float cosine, sine;
};
/// Of a line within a cone no more than the sine goes sideways, and no more than the tangent of what goes along its
/// axis. `gap`: between the leaves, sideways; `tallest`: from one to the other, along the axis.
HWY_INLINE bool liesBeside(float gap, float tallest, const Touch& touch, const LeafPose& pose) {
    return touch.parts &&
           (gap > touch.sine * pose.reach || gap * touch.cosine > touch.sine * (tallest + pose.rounding));
}

/// Is the pair parted by one of the two cones?
HWY_INLINE bool isParted(const float (*cornerA)[3][4], const float (*cornerB)[3][4], const Touch& touchA,
                         const Touch& touchB, const Directions& inA, const Directions& inB, const LeafPose& pose) {
    const Extents16 ofA = extentsOf(cornerA, inA);
    const Extents16 ofB = extentsOf(cornerB, inB);
    const Float16 shift = wide(pose.translation[0]) * spreadA(inA.component[0]) +
                          wide(pose.translation[1]) * spreadA(inA.component[1]) +
                          wide(pose.translation[2]) * spreadA(inA.component[2]);
    const Float16 up = ofB.high + shift - ofA.low;    // from A's low end to B's high one
    const Float16 down = ofA.high - ofB.low - shift;  // from B's low end to A's high one
    const float rounding = 2 * pose.rounding;
    alignas(64) float above[16];
    alignas(64) float below[16];
    store(up, above);
    store(down, below);
    const auto larger = [](float x, float y) HWY_ATTR { return x > y ? x : y; };
    return liesBeside(-below[0] - rounding, larger(above[4], below[4]), touchA, pose) ||
           liesBeside(-below[8] - rounding, larger(above[12], below[12]), touchB, pose);
}

void leafKernel(const LeafSource& sourceA, const LeafSource& sourceB, const LeafPair* pairs, std::uint32_t count,
                const LeafPose& pose, LeafMasks& out) {
    const float* shapesA[16];
    const float* shapesB[16];
    for (std::uint32_t lane = 0; lane < 16; ++lane) {
        const LeafPair& pair = pairs[lane < count ? lane : 0];
        shapesA[lane] = reinterpret_cast<const float*>(sourceA.shapes + pair.leafA);
        shapesB[lane] = reinterpret_cast<const float*>(sourceB.shapes + pair.leafB);
    }
    const Leaves16 a = leavesOf(shapesA, pose);
    const Leaves16 b = leavesOf(shapesB, pose);
    Turn toA;
    Turn toB;
    Turn sizes;
    Turn sizesBack;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const float entry = pose.rotation[row][column];
            const float size = entry < 0 ? -entry : entry;
            toA.r[row][column] = toB.r[column][row] = entry;
            sizes.r[row][column] = sizesBack.r[column][row] = size;
        }
    }
    const Vector16 translation = {wide(pose.translation[0]), wide(pose.translation[1]), wide(pose.translation[2])};
    const Vector16 offset = turned(toA, b.center) + translation - a.center;
    const Vector16 offsetInB = turned(toB, offset);
    const BoxGaps inA = gapsOf(offset, a.half + turned(sizes, b.half));
    const BoxGaps inB = gapsOf(offsetInB, b.half + turned(sizesBack, a.half));
    const Float16 reach = wide(pose.reach);
    const Float16 squaredReach = reach * reach;
    out.within = bits((inA.square <= squaredReach) & (inB.square <= squaredReach)) & ((1U << count) - 1U);
    out.touching = out.overlapping = 0;
    if (out.within == 0U) {
        return;
    }
    const Float16 rounding = wide(pose.rounding);
    out.overlapping = bits(max(inA.largest, inB.largest) <= rounding) & out.within;

    // Cosine and sine of the sum of the three angles; from a half turn on the sine is negative.
    const Float16 zero = wide(0);
    const Float16 every = wide(-1);
    const Float16 sineOfBoth = a.sine * b.cosine + a.cosine * b.sine;
    const Float16 cosineOfBoth = a.cosine * b.cosine - a.sine * b.sine;
    const Float16 sine = sineOfBoth * wide(pose.moreCosine) + cosineOfBoth * wide(pose.moreSine);
    const Float16 cosine = cosineOfBoth * wide(pose.moreCosine) - sineOfBoth * wide(pose.moreSine);
    const Float16 against = -dot(a.axis, turned(toA, b.axis));
    const Float16 facing = pose.twoSided ? abs(against) : against;
    const Mask16 faces =
        (sineOfBoth <= zero) | (sine <= zero) | (a.cosine <= every) | (b.cosine <= every) | (facing >= cosine);
    out.touching = bits(faces) & out.within & ~(a.plain & b.plain);

    const std::uint32_t apart = out.touching & ~out.overlapping;
    if (apart == 0U) {
        return;
    }
    const Cone16 coneA = coneOf(a, offset, rounding);
    const Cone16 coneB = coneOf(b, -offsetInB, rounding);
    const Vector16 ofA[4] = {coneA.sideways, coneA.axis, turned(toA, coneB.sideways), turned(toA, coneB.axis)};
    const Vector16 ofB[4] = {turned(toB, coneA.sideways), turned(toB, coneA.axis), coneB.sideways, coneB.axis};
    const std::uint32_t beside =
        bits(boxesLieBeside(a, coneA, ofB[0], b.half, pose) | boxesLieBeside(b, coneB, ofA[2], a.half, pose)) & apart;
    out.touching &= ~beside;
    const std::uint32_t partsA = bits(coneA.parts);
    const std::uint32_t partsB = bits(coneB.parts);
    const std::uint32_t open = apart & ~beside & (partsA | partsB);
    if (open == 0U) {
        return;
    }
    alignas(64) float inFrameA[4][3][16];
    alignas(64) float inFrameB[4][3][16];
    alignas(64) float touch[4][16];
    storeDirections(ofA, inFrameA);
    storeDirections(ofB, inFrameB);
    store(a.touchCosine, touch[0]);
    store(a.touchSine, touch[1]);
    store(b.touchCosine, touch[2]);
    store(b.touchSine, touch[3]);
    for (std::uint32_t rest = open; rest != 0U; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        const Touch touchA{(partsA >> lane & 1U) != 0, touch[0][lane], touch[1][lane]};
        const Touch touchB{(partsB >> lane & 1U) != 0, touch[2][lane], touch[3][lane]};
        if (isParted(sourceA.blocks[pairs[lane].leafA].corner, sourceB.blocks[pairs[lane].leafB].corner, touchA, touchB,
                     directionsOf(inFrameA, lane), directionsOf(inFrameB, lane), pose)) {
            out.touching &= ~(1U << lane);
        }
    }
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>

#include <grapeshot/core/detail/kernel_table.hpp>
#include <grapeshot/narrowphase/detail/leaf_shape.hpp>

namespace grapeshot::detail {
namespace {

NormalCone coneOfAngle(float angle) {
    return {std::cos(angle), std::sin(angle)};
}

}  // namespace

LeafFilter::LeafFilter(const MeshModel& a, const MeshModel& b, const Pose& bInA, float lean, float reach)
    : m_a(&a), m_b(&b), m_bInA(bInA), m_twoSided(!a.solid || !b.solid) {
    // What rounding, and a rotation that is only nearly one, can take from a gap of boxes.
    m_rounding = 4e-6F * (a.tree.radius + b.tree.radius + bInA.translation.norm());
    m_reach = reach + m_rounding;
    m_more = moreSpread(lean);
    m_wider = coneOfAngle(coneWidening(lean) - leafSpare + edgeSpare);
    m_usual = lean <= usualLean;
}

LeafMasks LeafFilter::operator()(std::span<const LeafPair> pairs) const noexcept {
    LeafPose pose;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            pose.rotation[row][column] = m_bInA.rotation(row, column);
        }
        pose.translation[row] = m_bInA.translation[row];
    }
    pose.reach = m_reach;
    pose.rounding = m_rounding;
    pose.moreCosine = m_more.cosine;
    pose.moreSine = m_more.sine;
    pose.widerCosine = m_wider.cosine;
    pose.widerSine = m_wider.sine;
    pose.usual = m_usual;
    pose.twoSided = m_twoSided;
    LeafMasks masks;
    if (pairs.empty()) {
        return masks;
    }
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(leafKernel);
    kernel.chosen()({m_a->leafShapes.data(), m_a->tree.leaves.data()},
                    {m_b->leafShapes.data(), m_b->tree.leaves.data()}, pairs.data(),
                    static_cast<std::uint32_t>(pairs.size()), pose, masks);
    return masks;
}

}  // namespace grapeshot::detail
#endif
