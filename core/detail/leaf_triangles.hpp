// The kernels of triangle_batch.hpp for two leaf blocks of four triangles each:
// all sixteen combinations, lane = 4 a + b.
#pragma once

#include <cstdint>
#include <limits>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/core/triangle_batch.hpp>

namespace grapeshot::detail {

/// Four triangles, corner[c][axis][lane], as in LeafBlock.
using FourTriangles = float[3][3][4];

/// As `overlaps`; `a` in A's frame, `b` in B's. B's corners are moved first,
/// each coordinate as
/// ((r0 x + r1 y) + r2 z) + t in single precision, on every instruction set.
/// One work unit.
[[nodiscard]] std::uint32_t overlapsLeaves(const FourTriangles& a, const FourTriangles& b, const Pose& bInA) noexcept;

/// As `signedDistances`; results in A's frame. One work unit. With a
/// `maxDistance`, lanes that are easily seen to be farther apart get the
/// largest float as distance and no meaning in the rest; much cheaper where all
/// are.
void signedDistancesLeaves(const FourTriangles& a, const FourTriangles& b, const Pose& bInA, DistanceBatch& out,
                           float maxDistance = std::numeric_limits<float>::infinity()) noexcept;

}  // namespace grapeshot::detail
