// A piece of a surface cut in two.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/scf/detail/piece_measure.hpp>
#include <grapeshot/scf/detail/triangle_order.hpp>

namespace grapeshot::detail {

/// Triangles in a leaf.
inline constexpr std::size_t ballLeafSize = 16;

class PieceSplit {
  public:
    PieceSplit(TriangleOrder& of, PieceMeasure& measure) : m_of(of), m_measure(measure) {}
    /// Two parts, both not empty. A connected piece between its ends, so that all leaves but one are full; of others
    /// whole connected pieces to either side, as evenly as they allow. @pre more triangles than a leaf holds
    Sliced split(TriangleRange range, std::vector<TriangleRange>& parts);

  private:
    Sliced splitAlong(TriangleRange range, std::vector<TriangleRange>& parts);
    Sliced splitPieces(TriangleRange range, std::vector<TriangleRange>& parts);

    TriangleOrder& m_of;
    PieceMeasure& m_measure;
    std::vector<std::uint32_t> m_spare;
};

}  // namespace grapeshot::detail
