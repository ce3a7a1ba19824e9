// Sixteen pairs of balls, and the pairs of triangles of two leaves, at once. One call is one unit of work, but for
// `closeRows`, which says itself.
#pragma once

#include <cstdint>

#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot::detail {

/// The corners of a leaf's triangles where they are now, and boxes around them; in the common frame, m.
struct alignas(64) PosedLeaf {
    float corner[3][3][16];         ///< [corner][axis][lane]
    float low[3][16], high[3][16];  ///< of each triangle; of an unused lane, such that nothing is near
    float middle[3][16];            ///< centroids at rest
    float boxLow[3], boxHigh[3];    ///< of all; behind what is read in whole registers
};

/// Bit 4 a + b: the balls a and b of the two fours are at most `reach` apart. Also if a number is not finite.
[[nodiscard]] std::uint32_t touchingBalls(const FourBalls& a, const FourBalls& b, float reach) noexcept;

/// The same, and how much they overlap: weight[4 a + b] = 1 - distance of the centres / (sum of the radii + reach), 0
/// where they do not touch.
[[nodiscard]] std::uint32_t overlappingBalls(const FourBalls& a, const FourBalls& b, float reach,
                                             float (&weight)[16]) noexcept;

/// Bit 4 a + b: no two points of the balls are farther apart than `distance`.
[[nodiscard]] std::uint32_t ballsWithin(const FourBalls& a, const FourBalls& b, float distance) noexcept;

/// gap[4 a + b]: what is in the balls a and b is at least so far apart, m, >= 0; also 0 if a number is not finite.
/// between: the distance of their centres.
void gapsOfBalls(const FourBalls& a, const FourBalls& b, float (&gap)[16], float (&between)[16]) noexcept;

/// gap[4 a + b]: what is in the balls a and b is at least `reach` and so much more apart, m; negative where they touch
/// at that reach, by how much they do. Not more than 0 if a number is not finite. weight: as `overlappingBalls` has it.
void clearanceOfBalls(const FourBalls& a, const FourBalls& b, float reach, float (&gap)[16],
                      float (&weight)[16]) noexcept;

/// row[i]: triangles of b whose boxes are within `reach` of the box of triangle i of a. With an `exclusion` >= 0, those
/// whose centroids at rest are at most so far apart are left out. Returns the units: one, and one more for every
/// triangle of a whose box is near b's.
[[nodiscard]] std::uint32_t closeRows(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                                      std::uint16_t (&row)[16]) noexcept;

/// The same by the distance of the boxes, and in `clearance`, m: the boxes of all other pairs that are not left out are
/// at least the reach and so much more apart; infinite if there are none.
[[nodiscard]] std::uint32_t clearRows(const PosedLeaf& a, const PosedLeaf& b, float reach, float exclusion,
                                      std::uint16_t (&row)[16], float& clearance) noexcept;

}  // namespace grapeshot::detail
