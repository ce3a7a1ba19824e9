// When do balls on straight paths come within reach of each other? Sixteen pairs to a call, one unit of work.
#pragma once

#include <cstdint>

namespace grapeshot::detail {

/// Four balls side by side, and where their centres go in the time from 0 to 1.
struct alignas(16) SweptBalls {
    float center[3][4];  ///< m, at time 0
    float path[3][4];    ///< m
    float radius[4];     ///< m
};

/// One ball.
struct SweptBall {
    float center[3];
    float path[3];
    float radius;
};

/// Balls around the triangles of a leaf. Unused lanes repeat lane 0.
struct alignas(64) SweptLeaf {
    float center[3][16];
    float path[3][16];
    float radius[16];
    SweptBall whole;  ///< around all of it
};

/// Bit 4 a + b: balls a and b come within `reach`, before `limit`. time[4 a + b]: not before then, a little early.
/// Also if a number is not finite. overlap[4 a + b]: 1 - (least distance of the centres / sum of the radii)^2, with the
/// reach; 0 where they only graze each other, 1 where a centre goes through the other's.
[[nodiscard]] std::uint32_t sweptBallsMeet(const SweptBalls& a, const SweptBalls& b, float reach, float limit,
                                           float (&time)[16], float (&overlap)[16]) noexcept;

/// The same for one ball and those of a leaf, bit and place as its lane.
[[nodiscard]] std::uint32_t sweptLeafMeets(const SweptBall& one, const SweptLeaf& leaf, float reach, float limit,
                                           float (&time)[16], float (&overlap)[16]) noexcept;

}  // namespace grapeshot::detail
