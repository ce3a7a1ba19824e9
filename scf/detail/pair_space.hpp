// What is searched: two ball trees where they are, or one with itself; and how its parts are told apart.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

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

struct PairSpace {
    PosedTree* a = nullptr;
    PosedTree* b = nullptr;  ///< the same as `a` for a body with itself
    float reach = 0;         ///< m: pairs of triangles at most so far apart are contacts
    float exclusion = -1;    ///< m, between centroids at rest; negative: nothing is left out (two bodies)

    [[nodiscard]] bool isSelf() const { return a == b; }

    /// A pair of pieces and its mirror image are one, and so are those of triangles.
    [[nodiscard]] bool excludes(std::uint32_t triangleA, std::uint32_t triangleB) const {
        if (!isSelf()) {
            return false;
        }
        for (const std::uint32_t v : a->tree().surface.triangles[triangleA]) {
            for (const std::uint32_t w : a->tree().surface.triangles[triangleB]) {
                if (v == w) {
                    return true;
                }
            }
        }
        return false;
    }

    /// Sixteen balls against each other: one unit, two for a body with itself. Both must not be leaves.
    /// @param weight as overlappingBalls has it; null: not wanted. A piece with itself has weight 1
    std::uint64_t expand(const BallPair& pair, ChildPairs& out, float (*weight)[16]) const;
};

inline std::uint64_t PairSpace::expand(const BallPair& pair, ChildPairs& out, float (*weight)[16]) const {
    struct Side {
        FourBalls ball;  // of a leaf
        const FourBalls* balls;
        std::uint32_t count;
    };
    const auto sideOf = [](PosedTree& tree, BallRef ref, std::array<BallRef, 4>& child, Side& side) {
        if (isBallLeaf(ref)) {
            side.ball = tree.ballOfLeaf(ballIndex(ref));
            side.balls = &side.ball;
            side.count = 1;
            child[0] = ref;
        } else {
            const BallNode& node = tree.node(ballIndex(ref));
            side.balls = &tree.balls(ballIndex(ref));
            side.count = node.count;
            child = {node.child[0], node.child[1], node.child[2], node.child[3]};
        }
    };
    static constexpr std::uint32_t rows[4] = {0x000f, 0x00ff, 0x0fff, 0xffff};
    static constexpr std::uint32_t columns[4] = {0x1111, 0x3333, 0x7777, 0xffff};
    Side sideA;
    Side sideB;
    sideOf(*a, pair.a, out.a, sideA);
    sideOf(*b, pair.b, out.b, sideB);
    const std::uint32_t lanes = rows[sideA.count - 1] & columns[sideB.count - 1];
    if (weight != nullptr) {
        out.mask = lanes & overlappingBalls(*sideA.balls, *sideB.balls, reach, *weight);
    } else {
        out.mask = lanes & touchingBalls(*sideA.balls, *sideB.balls, reach);
    }
    if (!isSelf()) {
        return 1;
    }
    if (pair.a == pair.b) {
        out.mask &= 0x8cefU;  // b >= a: each pair once, and each piece with itself
        if (weight != nullptr) {
            for (const int lane : {0, 5, 10, 15}) {
                (*weight)[lane] = 1;
            }
        }
    }
    if (isBallLeaf(pair.a) || isBallLeaf(pair.b)) {
        return 1;
    }
    out.mask &= ~ballsWithin(a->tree().restBalls[ballIndex(pair.a)], b->tree().restBalls[ballIndex(pair.b)], exclusion);
    return 2;
}

}  // namespace grapeshot::detail
