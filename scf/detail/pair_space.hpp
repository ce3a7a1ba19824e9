// What is searched: two ball trees where they are, or one with itself; and how its parts are told apart.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include <grapeshot/scf/detail/posed_tree.hpp>

namespace grapeshot::detail {

/// Two pieces, one of each tree.
struct BallPair {
    BallRef a = noBall;
    BallRef b = noBall;
    friend bool operator==(const BallPair&, const BallPair&) = default;
};

/// Pieces of both that may be near each other, lane 4 a + b.
struct ChildPairs {
    std::uint32_t mask = 0;
    std::array<BallRef, 4> a{}, b{};
    [[nodiscard]] BallPair at(unsigned lane) const { return {a[lane >> 2U], b[lane & 3U]}; }
};

[[nodiscard]] inline bool shareCorner(const Surface& surface, std::uint32_t first, std::uint32_t second) {
    for (const std::uint32_t v : surface.triangles[first]) {
        for (const std::uint32_t w : surface.triangles[second]) {
            if (v == w) {
                return true;
            }
        }
    }
    return false;
}

struct PairSpace {
    PosedTree* a = nullptr;
    PosedTree* b = nullptr;  ///< the same as `a` for a body with itself
    float reach = 0;         ///< m: pairs of triangles at most so far apart are contacts
    float exclusion = -1;    ///< m, between centroids at rest; negative: nothing is left out (two bodies)

    [[nodiscard]] bool isSelf() const { return a == b; }

    /// A pair of pieces and its mirror image are one, and so are those of triangles.
    [[nodiscard]] bool excludes(std::uint32_t triangleA, std::uint32_t triangleB) const {
        return isSelf() && shareCorner(a->tree().surface, triangleA, triangleB);
    }

    /// Shares a vertex, or stood within the exclusion at rest. Of two bodies nothing.
    [[nodiscard]] bool leavesOut(std::uint32_t triangleA, std::uint32_t triangleB) const {
        if (!isSelf()) {
            return false;
        }
        const Surface& surface = a->tree().surface;
        const auto middle = [&](std::uint32_t t) {
            const Triangle& corners = surface.triangles[t];
            return Eigen::Vector3f((surface.rest[corners[0]] + surface.rest[corners[1]] + surface.rest[corners[2]]) /
                                   3);
        };
        return shareCorner(surface, triangleA, triangleB) ||
               (middle(triangleA) - middle(triangleB)).squaredNorm() <= exclusion * exclusion;
    }

    /// Sixteen balls against each other: one unit, two for a body with itself. Not both whole; leaves always are.
    /// @param weight as overlappingBalls has it; null: not wanted. A piece with itself has weight 1
    /// @param wholeA do not open this one, which is not the root
    std::uint64_t expand(const BallPair& pair, ChildPairs& out, float (*weight)[16], bool wholeA = false,
                         bool wholeB = false) const;

    /// The same, but also with children that are up to `skin` (m) beyond the reach.
    /// @param gap of the lanes in the mask, m: how far beyond the reach, negative where the balls touch
    /// @param clearance m: all triangles of the other lanes are so much beyond the reach, or left out; infinite: there
    /// are no others
    std::uint64_t expandWithin(const BallPair& pair, float skin, ChildPairs& out, float (&gap)[16], float (&weight)[16],
                               float& clearance, bool wholeA = false, bool wholeB = false) const;
};

/// The children of a piece, or the piece itself in place of them. Of a tree where it is, or of one in motion.
template <class PlacedTree, class Balls>
struct OpenPiece {
    Balls ownBall{};
    FourBalls ownRestBall{};
    const Balls* balls = &ownBall;
    const FourBalls* restBalls = &ownRestBall;
    std::uint32_t count = 1;

    OpenPiece(PlacedTree& posed, BallRef ref, bool whole, bool isSelf, std::array<BallRef, 4>& child) {
        const BallTree& tree = posed.tree();
        if (!whole && !isBallLeaf(ref)) {
            const BallNode& node = posed.node(ballIndex(ref));
            balls = &posed.balls(ballIndex(ref));
            restBalls = &tree.restBalls[ballIndex(ref)];
            count = node.count;
            child = {node.child[0], node.child[1], node.child[2], node.child[3]};
            return;
        }
        child[0] = ref;
        posed.putBall(ref, ownBall, 0);
        if (isSelf) {
            const PieceBall& own = tree.own(ref);
            for (int axis = 0; axis < 3; ++axis) {
                ownRestBall.center[axis][0] = tree.surface.rest[own.center][axis];
            }
            ownRestBall.radius[0] = own.restRadius;
        }
    }
    OpenPiece(const OpenPiece&) = delete;
    OpenPiece& operator=(const OpenPiece&) = delete;
};

/// The lanes of so many pieces of A and of B.
[[nodiscard]] inline std::uint32_t lanesOf(std::uint32_t countA, std::uint32_t countB) {
    static constexpr std::uint32_t rows[4] = {0x000f, 0x00ff, 0x0fff, 0xffff};
    static constexpr std::uint32_t columns[4] = {0x1111, 0x3333, 0x7777, 0xffff};
    return rows[countA - 1] & columns[countB - 1];
}
/// Of a piece with itself: b >= a, each pair once, and each piece with itself.
inline constexpr std::uint32_t lanesOfOne = 0x8cefU;

inline std::uint64_t PairSpace::expand(const BallPair& pair, ChildPairs& out, float (*weight)[16], bool wholeA,
                                       bool wholeB) const {
    const OpenPiece<PosedTree, FourBalls> pieceA(*a, pair.a, wholeA, isSelf(), out.a);
    const OpenPiece<PosedTree, FourBalls> pieceB(*b, pair.b, wholeB, isSelf(), out.b);
    out.mask = lanesOf(pieceA.count, pieceB.count);
    out.mask &= weight != nullptr ? overlappingBalls(*pieceA.balls, *pieceB.balls, reach, *weight)
                                  : touchingBalls(*pieceA.balls, *pieceB.balls, reach);
    if (!isSelf()) {
        return 1;
    }
    if (pair.a == pair.b) {
        out.mask &= lanesOfOne;
        if (weight != nullptr) {
            for (const int lane : {0, 5, 10, 15}) {
                (*weight)[lane] = 1;
            }
        }
    }
    out.mask &= ~ballsWithin(*pieceA.restBalls, *pieceB.restBalls, exclusion);
    return 2;
}

inline std::uint64_t PairSpace::expandWithin(const BallPair& pair, float skin, ChildPairs& out, float (&gap)[16],
                                             float (&weight)[16], float& clearance, bool wholeA, bool wholeB) const {
    const OpenPiece<PosedTree, FourBalls> pieceA(*a, pair.a, wholeA, isSelf(), out.a);
    const OpenPiece<PosedTree, FourBalls> pieceB(*b, pair.b, wholeB, isSelf(), out.b);
    clearanceOfBalls(*pieceA.balls, *pieceB.balls, reach, gap, weight);
    out.mask = lanesOf(pieceA.count, pieceB.count);
    if (isSelf()) {
        if (pair.a == pair.b) {
            out.mask &= lanesOfOne;
            for (const int lane : {0, 5, 10, 15}) {
                weight[lane] = 1;
            }
        }
        out.mask &= ~ballsWithin(*pieceA.restBalls, *pieceB.restBalls, exclusion);
    }
    clearance = std::numeric_limits<float>::infinity();
    for (std::uint32_t rest = out.mask; rest != 0U; rest &= rest - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(rest));
        if (gap[lane] > skin) {
            out.mask &= ~(1U << lane);
            clearance = std::min(clearance, gap[lane]);
        }
    }
    return isSelf() ? 2 : 1;
}

}  // namespace grapeshot::detail
