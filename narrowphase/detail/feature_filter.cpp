#include <grapeshot/narrowphase/detail/feature_filter.hpp>

#include <grapeshot/core/detail/wide_targets.hpp>
#undef HWY_TARGET_INCLUDE
// NOLINTNEXTLINE(bugprone-macro-parentheses)
#define HWY_TARGET_INCLUDE <grapeshot/narrowphase/detail/feature_filter.cpp>
#include <hwy/foreach_target.h>

#include <grapeshot/core/detail/wide.hpp>

HWY_BEFORE_NAMESPACE();
namespace grapeshot::detail::HWY_NAMESPACE {

HWY_INLINE Vector16 spreadRows(const float (&rows)[3][4]) {
    return {spreadA(rows[0]), spreadA(rows[1]), spreadA(rows[2])};
}
HWY_INLINE Vector16 repeatRows(const float (&rows)[3][4]) {
    return {repeatB(rows[0]), repeatB(rows[1]), repeatB(rows[2])};
}

/// A mask of A's or B's lanes for the sixteen.
HWY_INLINE std::uint32_t spreadMask(std::uint32_t four) {
    return ((four & 1U) | (four & 2U) << 3U | (four & 4U) << 6U | (four & 8U) << 9U) * 15U;
}
HWY_INLINE std::uint32_t repeatMask(std::uint32_t four) {
    return four * 0x1111U;
}

HWY_INLINE Float16 min3(const Float16 (&x)[3]) {
    return min(min(x[0], x[1]), x[2]);
}
HWY_INLINE Float16 max3(const Float16 (&x)[3]) {
    return max(max(x[0], x[1]), x[2]);
}
constexpr int next(int i) {
    return i == 2 ? 0 : i + 1;
}
constexpr int previous(int i) {
    return i == 0 ? 2 : i - 1;
}

/// One triangle of each pair, spread or repeated. Its edges are loaded when they are needed: most pairs end before.
struct Outline16 {
    Vector16 corner[3], normal;
    Vector16 along[3];
    Float16 length[3];
};
/// The directions that the corners can be touched in.
struct Cones16 {
    Vector16 upward[3];
    Float16 cosine[3];
};
HWY_INLINE Cones16 conesA(const LeafRows& leaf) {
    Cones16 out;
    for (int i = 0; i < 3; ++i) {
        out.upward[i] = spreadRows(leaf.upward[i]);
        out.cosine[i] = spreadA(leaf.coneCosine[i]);
    }
    return out;
}
HWY_INLINE Cones16 conesB(const LeafRows& leaf) {
    Cones16 out;
    for (int i = 0; i < 3; ++i) {
        out.upward[i] = repeatRows(leaf.upward[i]);
        out.cosine[i] = repeatB(leaf.coneCosine[i]);
    }
    return out;
}
HWY_INLINE Outline16 cornersA(const LeafRows& leaf) {
    Outline16 out;
    for (int i = 0; i < 3; ++i) {
        out.corner[i] = spreadRows(leaf.corner[i]);
    }
    out.normal = spreadRows(leaf.normal);
    return out;
}
HWY_INLINE Outline16 cornersB(const LeafRows& leaf) {
    Outline16 out;
    for (int i = 0; i < 3; ++i) {
        out.corner[i] = repeatRows(leaf.corner[i]);
    }
    out.normal = repeatRows(leaf.normal);
    return out;
}
HWY_INLINE void loadEdgesA(const LeafRows& leaf, Outline16& out) {
    for (int i = 0; i < 3; ++i) {
        out.along[i] = spreadRows(leaf.along[i]);
        out.length[i] = spreadA(leaf.length[i]);
    }
}
HWY_INLINE void loadEdgesB(const LeafRows& leaf, Outline16& out) {
    for (int i = 0; i < 3; ++i) {
        out.along[i] = repeatRows(leaf.along[i]);
        out.length[i] = repeatB(leaf.length[i]);
    }
}

struct Slack {
    Float16 length;   ///< of coordinates, m
    Float16 reach;    ///< maxDistance and that
    Float16 lateral;  ///< how far before a Voronoi plane a corner within reach still counts, m
    float lean;
};

/// Corners of one triangle over the other's plane, and beyond its edges.
struct CornersOverFace {
    Float16 height[3];     ///< [corner] above the plane
    Float16 beyond[3][3];  ///< [corner][edge]: out of the face across the edge, in its plane, m
};

HWY_INLINE void heightsOver(const Outline16& face, const Outline16& other, Float16 (&height)[3]) {
    for (int c = 0; c < 3; ++c) {
        height[c] = dot(face.normal, other.corner[c] - face.corner[0]);
    }
}

/// Fills `beyond`; which pairs neither the face's plane nor one through an edge of it, nor both together, part by more
/// than the reach. `gap`: to the plane.
template <class Outwards>
HWY_INLINE Mask16 beyondEdges(const Outline16& face, const Outline16& other, Float16 gap, const Slack& slack,
                              const Outwards& outwards, CornersOverFace& over) {
    Mask16 near = allLanes();
    const Float16 left = slack.reach * slack.reach * wide(1 + 1e-5F) - gap * gap;
    for (int e = 0; e < 3; ++e) {
        const Vector16 out = outwards(e);
        Float16 nearest = wide(0);
        for (int c = 0; c < 3; ++c) {
            over.beyond[c][e] = dot(out, other.corner[c] - face.corner[e]);
            nearest = c == 0 ? over.beyond[c][e] : min(nearest, over.beyond[c][e]);
        }
        near = near & ((nearest <= wide(0)) | (nearest * nearest <= left));
    }
    return near;
}

/// Corners that may be over the face, and those behind it and beyond an edge with a gap beside it.
HWY_INLINE void overFace(const Outline16& face, const Outline16& other, const Cones16& cones, const Slack& slack,
                         bool solidFace, bool solidOther, const CornersOverFace& over, const std::uint32_t (&gap)[3],
                         std::uint32_t (&out)[3]) {
    const Float16 zero = wide(0);
    for (int c = 0; c < 3; ++c) {
        if (out[c] == 0U) {
            continue;
        }
        // The edges at the corner rise from it (towards the side that its body is on: of a sheet, either).
        const Float16 climbNext = over.height[next(c)] - over.height[c];
        const Float16 climbPrevious = over.height[previous(c)] - over.height[c];
        const Float16 leastNext = -(other.length[c] * wide(slack.lean) + slack.length);
        const Float16 leastPrevious = -(other.length[previous(c)] * wide(slack.lean) + slack.length);
        Mask16 rises = (climbNext >= leastNext) & (climbPrevious >= leastPrevious) & (over.height[c] <= slack.reach);
        Mask16 behind = over.height[c] < slack.length;
        if (!solidFace) {
            rises = rises |
                    ((-climbNext >= leastNext) & (-climbPrevious >= leastPrevious) & (-over.height[c] <= slack.reach));
            behind = behind | (over.height[c] > zero);
        }
        // The face is within the cone of directions that the corner can be touched in. (The way out to a gap beside it
        // is another direction.)
        const Float16 facing = -dot(cones.upward[c], face.normal);
        const Mask16 inCone = (solidFace && solidOther ? facing : abs(facing)) >= cones.cosine[c] - wide(1e-4F);
        out[c] &= bits(rises);
        if (out[c] == 0U) {
            continue;
        }
        std::uint32_t beside = 0;
        Mask16 inside = inCone;
        for (int e = 0; e < 3; ++e) {
            const Float16 tolerated = slack.length + face.length[e] * wide(2e-5F) + abs(over.height[c]) * wide(2e-3F);
            const Mask16 within = over.beyond[c][e] <= tolerated;
            inside = inside & within;
            beside |= bits(over.beyond[c][e] >= -tolerated) & gap[e];
        }
        out[c] &= bits(inside) | (beside & bits(behind));
    }
}

/// Corners that may be nearest to the edges of the face's triangle, in the wedge between its two
/// faces. `across(e)`: normal of the other face at the edge.
template <class Across>
HWY_INLINE void beforeEdges(const Outline16& face, const Outline16& other, const Slack& slack, const Across& across,
                            const CornersOverFace& over, std::uint32_t (&out)[3][3]) {
    const Float16 squaredReach = slack.reach * slack.reach;
    Float16 ends[3];
    for (int e = 0; e < 3; ++e) {  // rounding turns a short edge's direction
        ends[e] = slack.length + face.length[e] * wide(1e-5F) +
                  slack.length * slack.reach / max(face.length[e], wide(1e-30F));
    }
    for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < 3; ++e) {
            if (out[c][e] == 0U) {
                continue;
            }
            const Vector16 from = other.corner[c] - face.corner[e];
            const Float16 forward = dot(face.along[e], from);
            const Float16 square = over.height[c] * over.height[c] + over.beyond[c][e] * over.beyond[c][e];
            const Mask16 near = (square <= squaredReach) & (over.beyond[c][e] >= -slack.lateral) &
                                (forward >= -ends[e]) & (forward <= face.length[e] + ends[e]);
            out[c][e] &= bits(near);
            if (out[c][e] != 0U) {
                const Vector16 beyond = cross(across(e), face.along[e]);  // out of the other face
                out[c][e] &= bits(dot(beyond, from) >= -slack.lateral);
            }
        }
    }
}

/// Do the lines of two edges pass within reach (or at any distance, where the triangles may cut each other), at points
/// of both edges? Of nearly parallel edges that is not asked.
HWY_INLINE Mask16 meet(const Outline16& a, int i, const Outline16& b, int j, Mask16 crossing, const Slack& slack) {
    const Vector16 common = cross(a.along[i], b.along[j]);
    const Float16 squaredSine = dot(common, common);
    const Vector16 offset = b.corner[j] - a.corner[i];
    const Float16 gap = dot(offset, common);
    // Both times the squared sine. Parallel faces lend their normal, which may differ by 0.02 rad from the common one
    // and moves the crossing by that much of the gap (which is here times the sine).
    const Float16 alongA = dot(cross(offset, b.along[j]), common);
    const Float16 alongB = dot(cross(offset, a.along[i]), common);
    const Float16 off = squaredSine * (slack.length * wide(50.0F)) + abs(gap) * wide(0.03F) / sqrt(squaredSine);
    const Float16 longA = a.length[i] * squaredSine;
    const Float16 longB = b.length[j] * squaredSine;
    const Float16 offA = off + longA * wide(1e-4F);
    const Float16 offB = off + longB * wide(1e-4F);
    const Mask16 near = crossing | (gap * gap <= squaredSine * slack.reach * slack.reach * wide(1.01F));
    const Mask16 meets =
        near & (alongA >= -offA) & (alongA <= longA + offA) & (alongB >= -offB) & (alongB <= longB + offB);
    return meets | (squaredSine < wide(1e-3F));
}

/// Do edges i and j cross where both are locally extremal? With the common normal along their cross product, the limits
/// on the four faces come down to how the other edge climbs over them.
template <class AcrossA, class AcrossB>
HWY_INLINE void crossEdges(const Outline16& a, const Outline16& b, Mask16 crossing, const Slack& slack,
                           Float16 exactLean, const std::uint32_t (&sharp)[3][3], const AcrossA& acrossA,
                           const AcrossB& acrossB, std::uint32_t (&out)[3][3]) {
    Float16 ownA[3];  // [edge of B]: its climb over A's face
    Float16 ownB[3];  // [edge of A]
    for (int i = 0; i < 3; ++i) {
        ownA[i] = dot(a.normal, b.along[i]);
        ownB[i] = dot(b.normal, a.along[i]);
    }
    const Float16 sharpLean = wide(slack.lean + 0.022F);  // parallel within 0.02 rad counts as parallel
    for (int i = 0; i < 3; ++i) {
        const Vector16 farA = acrossA(i);
        for (int j = 0; j < 3; ++j) {
            if (out[i][j] == 0U) {
                continue;
            }
            const Float16 farB = dot(acrossB(j), a.along[i]);
            const Float16 farOfA = dot(farA, b.along[j]);
            const Float16 forward = max(max(ownA[j], -farOfA), max(ownB[i], -farB));
            const Float16 backward = max(max(-ownA[j], farOfA), max(-ownB[i], farB));
            const Float16 leans = min(forward, backward);
            out[i][j] &= bits(leans <= exactLean) | (bits(leans <= sharpLean) & sharp[i][j]);
            if (out[i][j] != 0U) {
                out[i][j] &= bits(meet(a, i, b, j, crossing, slack));
            }
        }
    }
}

/// Is corner i of A within reach of corner j of B, each before the ends of the edges at the other?
HWY_INLINE Mask16 cornersMeet(const Outline16& a, int i, const Outline16& b, int j, const Slack& slack) {
    const Vector16 apart = b.corner[j] - a.corner[i];
    // The way along an edge from the corner, and back from its other end.
    const auto beforeBoth = [&](const Outline16& own, int corner, Vector16 offset) HWY_ATTR {
        return (dot(own.along[corner], offset) <= slack.lateral) &
               (dot(own.along[previous(corner)], offset) >= -slack.lateral);
    };
    return (dot(apart, apart) <= slack.reach * slack.reach) & beforeBoth(a, i, apart) & beforeBoth(b, j, -apart);
}

void featureKernel(const LeafRows& leafA, const LeafRows& leafB, const FeatureLimits& limits, FeatureMasks& out) {
    Outline16 a = cornersA(leafA);
    Outline16 b = cornersB(leafB);
    const float rounding = 8 * limits.rounding;
    const Slack slack{wide(rounding), wide(limits.maxDistance + rounding),
                      wide(2e-3F * limits.maxDistance + 2 * rounding), limits.lean + 1e-4F};
    out.any = 0;
    out.overlapping = 0;

    CornersOverFace overA;
    CornersOverFace overB;
    heightsOver(a, b, overA.height);
    heightsOver(b, a, overB.height);
    const Float16 lowA = min3(overA.height);
    const Float16 lowB = min3(overB.height);
    const Float16 highA = max3(overA.height);
    const Float16 highB = max3(overB.height);
    const std::uint32_t valid = spreadMask(leafA.valid) & repeatMask(leafB.valid);
    const Float16 below = -slack.length;
    const Mask16 crossing = (lowA <= slack.length) & (highA >= below) & (lowB <= slack.length) & (highB >= below);
    if (limits.overlaps) {
        out.overlapping = bits(crossing) & valid;
    }
    if (!limits.contacts) {
        return;
    }
    // A plane with the whole other triangle beyond reach parts the two.
    Mask16 near = (lowA <= slack.reach) & (lowB <= slack.reach) & (highA >= -slack.reach) & (highB >= -slack.reach);
    std::uint32_t open = bits(near) & valid;
    if (open == 0U) {
        return;
    }
    const Float16 zero = wide(0);
    near = beyondEdges(
        a, b, max(max(lowA, -highA), zero), slack, [&](int e) HWY_ATTR { return spreadRows(leafA.outward[e]); }, overA);
    near = near & beyondEdges(
                      b, a, max(max(lowB, -highB), zero), slack,
                      [&](int e) HWY_ATTR { return repeatRows(leafB.outward[e]); }, overB);
    open &= bits(near);
    if (open == 0U) {
        return;
    }

    loadEdgesA(leafA, a);
    loadEdgesB(leafB, b);
    std::uint32_t gapA[3];
    std::uint32_t gapB[3];
    std::uint32_t sharp[3][3];
    // Every contact once, from the first triangles at its corner and edge. Where triangles cut each other, from all:
    // what lies deep in the other counts only if its own triangle does (FeatureContacts::counts).
    const std::uint32_t cuts = open & bits(crossing);
    std::uint32_t cornersB[3];
    std::uint32_t edgesB[3];
    for (int j = 0; j < 3; ++j) {
        cornersB[j] = repeatMask(leafB.sharpCorner[j]) & open & (cuts | repeatMask(leafB.ownCorner[j]));
        edgesB[j] = repeatMask(leafB.bent[j]) & open & (cuts | repeatMask(leafB.ownEdge[j]));
        out.cornerBFaceA[j] = cornersB[j];
    }
    std::uint32_t more = 0;  // pairs that can have more than a corner over a face
    for (int i = 0; i < 3; ++i) {
        gapA[i] = spreadMask(leafA.gap[i]);
        gapB[i] = repeatMask(leafB.gap[i]);
        const std::uint32_t cornerA = spreadMask(leafA.sharpCorner[i]) & open & (cuts | spreadMask(leafA.ownCorner[i]));
        const std::uint32_t edgeA = spreadMask(leafA.bent[i]) & open & (cuts | spreadMask(leafA.ownEdge[i]));
        out.cornerAFaceB[i] = cornerA;
        for (int j = 0; j < 3; ++j) {
            out.edges[i][j] = edgeA & edgesB[j];
            out.cornerAEdgeB[i][j] = cornerA & edgesB[j];
            out.cornerBEdgeA[j][i] = cornersB[j] & edgeA;
            out.corners[i][j] = cornerA & cornersB[j];
            sharp[i][j] = spreadMask(leafA.sharp[i]) & repeatMask(leafB.sharp[j]);
            more |= out.edges[i][j] | out.cornerAEdgeB[i][j] | out.cornerBEdgeA[j][i] | out.corners[i][j];
        }
    }
    overFace(a, b, conesB(leafB), slack, limits.solidA, limits.solidB, overA, gapA, out.cornerBFaceA);
    overFace(b, a, conesA(leafA), slack, limits.solidB, limits.solidA, overB, gapB, out.cornerAFaceB);
    std::uint32_t any = 0;
    for (int i = 0; i < 3; ++i) {
        any |= out.cornerBFaceA[i] | out.cornerAFaceB[i];
    }
    if (more == 0U) {
        out.any = any;
        return;
    }

    beforeEdges(
        a, b, slack, [&](int e) HWY_ATTR { return spreadRows(leafA.across[e]); }, overA, out.cornerBEdgeA);
    beforeEdges(
        b, a, slack, [&](int e) HWY_ATTR { return repeatRows(leafB.across[e]); }, overB, out.cornerAEdgeB);
    // Edges that touch within rounding may lean by more: no direction is known of them.
    const Float16 gapBetween = max(max(lowA, lowB), wide(0));
    const Float16 exactLean =
        min(wide(0.101F), wide(2e-3F) + slack.length / (gapBetween + wide(limits.rounding + 1e-30F)));
    crossEdges(
        a, b, crossing, slack, exactLean, sharp, [&](int e) HWY_ATTR { return spreadRows(leafA.across[e]); },
        [&](int e) HWY_ATTR { return repeatRows(leafB.across[e]); }, out.edges);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (out.corners[i][j] != 0U) {
                out.corners[i][j] &= bits(cornersMeet(a, i, b, j, slack));
            }
            any |= out.edges[i][j] | out.cornerBEdgeA[i][j] | out.cornerAEdgeB[i][j] | out.corners[i][j];
        }
    }
    out.any = any;
}

}  // namespace grapeshot::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <grapeshot/core/detail/kernel_table.hpp>

namespace grapeshot::detail {

void filterFeatures(const LeafRows& a, const LeafRows& b, const FeatureLimits& limits, FeatureMasks& out) noexcept {
    static constexpr auto kernel = GRAPESHOT_KERNEL_TABLE(featureKernel);
    kernel.chosen()(a, b, limits, out);
}

}  // namespace grapeshot::detail
#endif
