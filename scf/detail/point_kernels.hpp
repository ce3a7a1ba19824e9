// A point and the sixteen triangles of a leaf.
#pragma once

#include <cstdint>

#include <grapeshot/scf/detail/ball_kernels.hpp>

namespace grapeshot::detail {

struct alignas(64) PointDistances {
    float square[16];      ///< m^2
    float between[3][16];  ///< from the closest point to the asked one, m
    float feature[16];     ///< 0..2 corner, 3..5 edge, 6 face
};

/// Bit per lane: the triangle is nearer than the root of `most`, m^2. Lanes that are unused repeat the first one. One
/// unit of work.
[[nodiscard]] std::uint32_t pointDistances(const PosedLeaf& leaf, const float (&point)[3], float most,
                                           PointDistances& out) noexcept;

}  // namespace grapeshot::detail
