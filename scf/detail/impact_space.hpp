// What is searched for an impact: two ball trees in motion, or one with itself.
#pragma once

#include <bit>
#include <cstdint>

#include <grapeshot/scf/detail/moving_tree.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

struct ImpactSpace {
    MovingTree* a = nullptr;
    MovingTree* b = nullptr;  ///< the same as `a` for a body with itself
    float reach = 0;          ///< m: triangles at most so far apart are in contact
    float tolerance = 0;      ///< m: ... and this much more
    float exclusion = -1;     ///< as PairSpace has it

    [[nodiscard]] bool isSelf() const { return a == b; }
    [[nodiscard]] bool turns() const { return a->turns() || b->turns(); }
    [[nodiscard]] float margin() const { return reach + tolerance; }

    /// Sixteen pairs of swept balls: one unit, two for a body with itself. Not both leaves.
    /// @param limit pairs that do not meet before are left out
    std::uint64_t expand(const BallPair& pair, float limit, ChildPairs& out, float (&time)[16],
                         float (&overlap)[16]) const {
        const OpenPiece<MovingTree, SweptBalls> pieceA(*a, pair.a, false, isSelf(), out.a);
        const OpenPiece<MovingTree, SweptBalls> pieceB(*b, pair.b, false, isSelf(), out.b);
        out.mask = lanesOf(pieceA.count, pieceB.count) &
                   sweptBallsMeet(*pieceA.balls, *pieceB.balls, margin(), limit, time, overlap);
        if (!isSelf()) {
            return 1;
        }
        if (pair.a == pair.b) {
            out.mask &= lanesOfOne;
        }
        out.mask &= ~ballsWithin(*pieceA.restBalls, *pieceB.restBalls, exclusion);
        return 2;
    }

    /// Pairs of triangles of two leaves that may meet before `limit`, to found(laneA, laneB, time, overlap). Returns
    /// the units: one, and one more for every triangle of A's that may meet B's leaf.
    template <class Found>
    std::uint64_t openLeaves(std::uint32_t leafA, std::uint32_t leafB, float limit, Found&& found) const;
};

template <class Found>
std::uint64_t ImpactSpace::openLeaves(std::uint32_t leafA, std::uint32_t leafB, float limit, Found&& found) const {
    const BallLeaf& ownA = a->tree().leaves[leafA];
    const BallLeaf& ownB = b->tree().leaves[leafB];
    const SweptLeaf& sweptA = a->leaf(leafA);
    const SweptLeaf& sweptB = b->leaf(leafB);
    const bool same = isSelf() && leafA == leafB;
    float time[16];
    float overlap[16];
    std::uint32_t near =
        sweptLeafMeets(sweptB.whole, sweptA, margin(), limit, time, overlap) & ((1U << ownA.count) - 1U);
    std::uint64_t units = 1;
    for (; near != 0U; near &= near - 1U) {
        const auto i = static_cast<unsigned>(std::countr_zero(near));
        const SweptBall one{{sweptA.center[0][i], sweptA.center[1][i], sweptA.center[2][i]},
                            {sweptA.path[0][i], sweptA.path[1][i], sweptA.path[2][i]},
                            sweptA.radius[i]};
        std::uint32_t row = sweptLeafMeets(one, sweptB, margin(), limit, time, overlap) & ((1U << ownB.count) - 1U);
        ++units;
        if (same) {
            row &= ~((2U << i) - 1U);
        }
        for (; row != 0U; row &= row - 1U) {
            const auto j = static_cast<unsigned>(std::countr_zero(row));
            if (isSelf()) {
                float square = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    const float d = ownA.middle[axis][i] - ownB.middle[axis][j];
                    square += d * d;
                }
                if (!(square > exclusion * exclusion) ||
                    shareCorner(a->tree().surface, ownA.triangle[i], ownB.triangle[j])) {
                    continue;
                }
            }
            found(i, j, time[j], overlap[j]);
        }
    }
    return units;
}

}  // namespace grapeshot::detail
