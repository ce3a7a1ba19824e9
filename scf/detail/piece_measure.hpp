// How a piece of a surface lies between its ends, and the balls around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/detail/geodesics.hpp>
#include <grapeshot/scf/detail/triangle_order.hpp>

namespace grapeshot::detail {

/// Of no use before `prepare` is through.
class PieceMeasure {
  public:
    explicit PieceMeasure(TriangleOrder& of) : m_of(of), m_geodesics(of.surface) {}
    Sliced prepare();

    /// For each triangle of a connected piece, in `keys`: how much nearer it is to one end than to the other, by paths
    /// within the piece. Once for a range, however often it is asked.
    Sliced measureKeys(TriangleRange range);
    [[nodiscard]] const std::vector<double>& keys() const { return m_key; }
    /// Around one of its own vertices, by path length. Of what is not connected infinite.
    Sliced putBallAround(TriangleRange range, PieceBall& best);
    /// `plainCenter` and `plainRadius`: nearly the smallest ball at rest.
    Sliced setPlainBall(TriangleRange range, PieceBall& own);

  private:
    Sliced findFirstEnd(std::size_t& end);
    static Sliced findFarthest(const std::vector<double>& distance, std::size_t& farthest);
    Sliced measureEnds(TriangleRange range);
    Sliced rememberKeys(TriangleRange range);
    Sliced takeFarther();
    Sliced tryNearest(PieceBall& ball);

    TriangleOrder& m_of;
    Geodesics m_geodesics;
    std::vector<double> m_key;
    TriangleRange m_keysOf;                         ///< whose keys they are
    std::vector<double> m_fromFirst, m_fromSecond;  ///< distances of the gathered vertices from both ends
};

}  // namespace grapeshot::detail
