#include <grapeshot/narrowphase/detail/leaf_filter.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/narrowphase/detail/leaf_filter.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

#ifndef GRAPESHOT_NARROWPHASE_DETAIL_LEAF_FILTER_ROWS
#define GRAPESHOT_NARROWPHASE_DETAIL_LEAF_FILTER_ROWS
namespace grapeshot::detail {

/// Sixteen leaves of one side, lane by lane, each in its mesh's frame.
struct alignas(64) LeafLanes {
    float center[3][16], half[3][16], axis[3][16];
    float cosine[16], sine[16];            // of the cone's half angle
    float touchCosine[16], touchSine[16];  // of that of the lines to what touches it; cosine <= 0: it parts nothing
    const float (*corner[16])[3][4];       // of the leaf block, [corner][axis][lane]
    std::uint32_t plain = 0;
};
struct LeafPose {
    float rotation[3][3];  // B's frame to A's
    float translation[3];
    float reach, rounding;
    float moreCosine, moreSine;
    bool twoSided;
};

}  // namespace grapeshot::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Vector16 loadRows(const float (&rows)[3][16]) {
    return {load(rows[0]), load(rows[1]), load(rows[2])};
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
HWY_INLINE Cone16 coneOf(const LeafLanes& own, Vector16 offset, Float16 rounding) {
    Cone16 cone;
    cone.axis = loadRows(own.axis);
    const Vector16 across = offset - cone.axis * dot(offset, cone.axis);
    cone.length = sqrt(dot(across, across));
    cone.parts = (load(own.touchCosine) > wide(0)) & (cone.length > rounding);
    cone.sideways = across * (wide(1) / max(cone.length, wide(1e-30F)));
    return cone;
}
/// Do the boxes alone tell that all lines leave the cone? `inOther`: sideways, in the other leaf's frame.
HWY_INLINE Mask16 boxesLieBeside(const LeafLanes& own, const Cone16& cone, Vector16 ownHalf, Vector16 inOther,
                                 Vector16 otherHalf, const LeafPose& pose) {
    const Float16 halves = dot(abs(cone.sideways), ownHalf) + dot(abs(inOther), otherHalf);
    const Float16 most = load(own.touchSine) * wide(pose.reach) + wide(2 * pose.rounding);
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

/// Of a line within a cone no more than the sine goes sideways, and no more than the tangent of what goes along its
/// axis. `gap`: between the leaves, sideways; `tallest`: from one to the other, along the axis.
HWY_INLINE bool liesBeside(float gap, float tallest, const LeafLanes& own, unsigned pair, const LeafPose& pose) {
    const float sine = own.touchSine[pair];
    return gap > sine * pose.reach || gap * own.touchCosine[pair] > sine * (tallest + pose.rounding);
}

/// Is the pair parted by one of the two cones? `parts`: bit 0 A's can, bit 1 B's.
HWY_INLINE bool partedBy(const LeafLanes& a, const LeafLanes& b, unsigned pair, std::uint32_t parts,
                         const Directions& inA, const Directions& inB, const LeafPose& pose) {
    const Extents16 ofA = extentsOf(a.corner[pair], inA);
    const Extents16 ofB = extentsOf(b.corner[pair], inB);
    const Float16 shift = wide(pose.translation[0]) * spreadA(inA.component[0]) +
                          wide(pose.translation[1]) * spreadA(inA.component[1]) +
                          wide(pose.translation[2]) * spreadA(inA.component[2]);
    alignas(64) float above[16];  // from A's low end to B's high one
    alignas(64) float below[16];  // from B's low end to A's high one
    store(ofB.high + shift - ofA.low, above);
    store(ofA.high - ofB.low - shift, below);
    const float rounding = 2 * pose.rounding;
    const auto larger = [](float x, float y) HWY_ATTR { return x > y ? x : y; };
    return ((parts & 1U) != 0 && liesBeside(-below[0] - rounding, larger(above[4], below[4]), a, pair, pose)) ||
           ((parts & 2U) != 0 && liesBeside(-above[8] - rounding, larger(above[12], below[12]), b, pair, pose));
}

void leafKernel(const LeafLanes& a, const LeafLanes& b, const LeafPose& pose, std::uint32_t valid, LeafMasks& out) {
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
    const Vector16 halfA = loadRows(a.half);
    const Vector16 halfB = loadRows(b.half);
    const Vector16 translation = {wide(pose.translation[0]), wide(pose.translation[1]), wide(pose.translation[2])};
    const Vector16 offset = turned(toA, loadRows(b.center)) + translation - loadRows(a.center);
    const Vector16 offsetInB = turned(toB, offset);
    const BoxGaps inA = gapsOf(offset, halfA + turned(sizes, halfB));
    const BoxGaps inB = gapsOf(offsetInB, halfB + turned(sizesBack, halfA));
    const Float16 reach = wide(pose.reach);
    const Float16 squaredReach = reach * reach;
    out.within = bits((inA.square <= squaredReach) & (inB.square <= squaredReach)) & valid;
    out.touching = out.overlapping = 0;
    if (out.within == 0U) {
        return;
    }
    const Float16 rounding = wide(pose.rounding);
    out.overlapping = bits(max(inA.largest, inB.largest) <= rounding) & out.within;

    // Cosine and sine of the sum of the three angles; from a half turn on the sine is negative.
    const Float16 cosineA = load(a.cosine);
    const Float16 cosineB = load(b.cosine);
    const Float16 sineA = load(a.sine);
    const Float16 sineB = load(b.sine);
    const Float16 zero = wide(0);
    const Float16 every = wide(-1);
    const Float16 sineOfBoth = sineA * cosineB + cosineA * sineB;
    const Float16 cosineOfBoth = cosineA * cosineB - sineA * sineB;
    const Float16 sine = sineOfBoth * wide(pose.moreCosine) + cosineOfBoth * wide(pose.moreSine);
    const Float16 cosine = cosineOfBoth * wide(pose.moreCosine) - sineOfBoth * wide(pose.moreSine);
    const Vector16 axisA = loadRows(a.axis);
    const Float16 facing = -dot(axisA, turned(toA, loadRows(b.axis)));
    Mask16 faces = (sineOfBoth <= zero) | (sine <= zero) | (cosineA <= every) | (cosineB <= every) | (facing >= cosine);
    if (pose.twoSided) {
        faces = faces | (-facing >= cosine);
    }
    out.touching = bits(faces) & out.within & ~(a.plain & b.plain);

    const std::uint32_t apart = out.touching & ~out.overlapping;
    if (apart == 0U) {
        return;
    }
    const Cone16 coneA = coneOf(a, offset, rounding);
    const Cone16 coneB = coneOf(b, -offsetInB, rounding);
    const Vector16 ofA[4] = {coneA.sideways, coneA.axis, turned(toA, coneB.sideways), turned(toA, coneB.axis)};
    const Vector16 ofB[4] = {turned(toB, coneA.sideways), turned(toB, coneA.axis), coneB.sideways, coneB.axis};
    const std::uint32_t beside = bits(boxesLieBeside(a, coneA, halfA, ofB[0], halfB, pose) |
                                      boxesLieBeside(b, coneB, halfB, ofA[2], halfA, pose)) &
                                 apart;
    out.touching &= ~beside;
    const std::uint32_t open = apart & ~beside;
    const std::uint32_t partsA = bits(coneA.parts);
    const std::uint32_t partsB = bits(coneB.parts);
    alignas(64) float inFrameA[4][3][16];
    alignas(64) float inFrameB[4][3][16];
    storeDirections(ofA, inFrameA);
    storeDirections(ofB, inFrameB);
    for (unsigned pair = 0; pair < 16; ++pair) {
        const std::uint32_t parts = (partsA >> pair & 1U) | (partsB >> pair & 1U) << 1U;
        if ((open >> pair & 1U) != 0 && parts != 0 &&
            partedBy(a, b, pair, parts, directionsOf(inFrameA, pair), directionsOf(inFrameB, pair), pose)) {
            out.touching &= ~(1U << pair);
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

void setLane(const MeshModel& model, std::uint32_t leaf, const NormalCone* wider, std::size_t lane, LeafLanes& to) {
    const LeafShape& shape = model.leafShapes[leaf];
    for (int axis = 0; axis < 3; ++axis) {
        to.center[axis][lane] = shape.center[axis];
        to.half[axis][lane] = shape.half[axis];
        to.axis[axis][lane] = shape.axis[axis];
    }
    to.cosine[lane] = shape.cosSpread;
    to.sine[lane] = shape.sinSpread;
    const bool usual = wider == nullptr;
    to.touchCosine[lane] = usual                 ? shape.touch.cosine
                           : shape.cosSpread > 0 ? shape.cosSpread * wider->cosine - shape.sinSpread * wider->sine
                                                 : shape.cosSpread;
    to.touchSine[lane] = usual ? shape.touch.sine : shape.sinSpread * wider->cosine + shape.cosSpread * wider->sine;
    to.corner[lane] = model.tree.leaves[leaf].corner;
    to.plain |= shape.plain ? 1U << lane : 0U;
}

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
    LeafLanes a;
    LeafLanes b;
    if (pairs.size() < width) {
        a = b = {};
    }
    const NormalCone* wider = m_usual ? nullptr : &m_wider;
    for (std::size_t lane = 0; lane < pairs.size(); ++lane) {
        setLane(*m_a, pairs[lane].leafA, wider, lane, a);
        setLane(*m_b, pairs[lane].leafB, wider, lane, b);
    }
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
    pose.twoSided = m_twoSided;
    LeafMasks masks;
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(leafKernel);
    kernel.chosen()(a, b, pose, (pairs.size() < width ? 1U << pairs.size() : 1U << width) - 1U, masks);
    return masks;
}

}  // namespace grapeshot::detail
#endif
