// From two vertices downhill to a nearer pair, along the edges of both surfaces.
//
// This work is based on:
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (neighbours of features)
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <cstdint>

#include <grapeshot/scf/detail/pair_batch.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

struct VertexPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    float square = 0;  ///< of the distance, m^2
};

/// The vertex of either side moves to its neighbour that is nearest to the other, in turn, until none is nearer, the
/// two are within reach, or the units are used up: one for each look at up to sixteen neighbours. Of a body with itself
/// it does not go into the neighbourhood that is left out.
[[nodiscard]] VertexPair descend(const PairSpace& space, std::uint32_t a, std::uint32_t b, int units,
                                 std::uint64_t& work);

/// The nearest two corners of two triangles.
[[nodiscard]] VertexPair nearestCorners(const PairSpace& space, const TrianglePair& pair);

}  // namespace grapeshot::detail
