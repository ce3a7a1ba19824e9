// Sixteen triangle pairs at once: do they overlap, and how far apart are they?
//
// This work is based on:
// Stefan Gottschalk. Separating axis theorem. TR96-024, UNC Chapel Hill. 1996 (overlap)
// Christer Ericson. Real-Time Collision Detection. 2005, sections 5.1.5, 5.1.9 (point-triangle, segment-segment)
#pragma once

#include <cstdint>
#include <limits>

namespace grapeshot {

/// Lanes of every wide kernel, on every instruction set.
inline constexpr int batchWidth = 16;

/// Sixteen triangles: corner[c][axis][lane], all in one frame.
struct alignas(64) TriangleBatch {
    float corner[3][3][batchWidth];
};

/// What the distance kernel says of sixteen pairs. For a lane whose triangles overlap: `signedDistance` is minus the
/// smallest translation that parts them (over the separating axes of both triangles), `onA` and `onB` are both the
/// middle of the intersection and `overlapping` has the lane's bit. Otherwise it is the Euclidean distance and the
/// witness points are a closest pair.
struct alignas(64) DistanceBatch {
    float signedDistance[batchWidth];
    float onA[3][batchWidth];
    float onB[3][batchWidth];
    /// Closest feature of each triangle: 0..2 corner, 3..5 edge (edge e runs from corner e-3 to the next), 6 face.
    std::int32_t featureA[batchWidth];
    std::int32_t featureB[batchWidth];
    std::uint32_t overlapping;  ///< bit per lane
};

/// Bit per lane: the two closed triangles share a point. Coplanar pairs are decided in their plane; triangles
/// degenerate to a segment or a point are decided as such. Accurate to about 1e-6 of the triangles' extent around their
/// first corners: the test is done relative to A's first corner. One work unit.
[[nodiscard]] std::uint32_t overlaps(const TriangleBatch& a, const TriangleBatch& b) noexcept;

/// Signed distance and witness points of sixteen pairs. One work unit. Lanes are independent: a lane's bytes do not
/// depend on the other lanes nor on the instruction set.
/// @param maxDistance m: lanes that are easily seen to be farther apart get the largest float as distance and no
/// meaning in the rest; much cheaper where all are
void signedDistances(const TriangleBatch& a, const TriangleBatch& b, DistanceBatch& out,
                     float maxDistance = std::numeric_limits<float>::infinity()) noexcept;

}  // namespace grapeshot
