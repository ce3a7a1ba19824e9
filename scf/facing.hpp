// Two surfaces, or one with itself, in a step: which triangles may meet on their ways, and which places the vertices
// face at the end. One contact per vertex and side follows from that, however many triangles are within a distance.
//
// What two neighbourhoods move together does not count: of two sheets that fall one on the other nothing meets.
//
// This work is based on:
// Christer Ericson. Real-Time Collision Detection. 2005, section 5.1.5 (closest point of a triangle)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>

namespace grapeshot {

/// Vertices at three times, in the common frame, m; straight ways between them. All as many as at rest, and finite.
struct SurfaceWay {
    std::span<const Eigen::Vector3f> last, before, after;
    float stretch = 1;  ///< of `before`, see measureStretch
};

struct FacingPlace {
    std::uint32_t vertex = 0;
    std::uint32_t triangle = 0;  ///< of the other surface, or of the same one
    float distance = 0;          ///< m, > 0: a vertex on the surface faces nothing
};

struct FacingResult {
    /// All pairs of triangles that come within `reach` on their ways, and some that do not. Ascending; of a body with
    /// itself without those that share a vertex, the lower triangle first.
    std::vector<TrianglePair> meeting;
    /// What vertices of A and of B face after the step; of one with itself all in the first. Of a vertex at most three
    /// local minima of its distance that are within the given one, in directions that differ by 37 degrees and more;
    /// the nearest first. The vertices of a leaf stand together.
    std::vector<FacingPlace> ofA, ofB;
    std::optional<Fault> fault;  ///< topologyChanged or badSetting; nothing is listed then
    bool complete = false;       ///< else it would have cost more than it may, or has a fault; nothing is listed then
    std::uint64_t work = 0;      ///< calls of 16-wide kernels
};

/// For one pair of surfaces, or one with itself; keeps its memory from call to call and no more. The trees must stay
/// where they are. Not for two threads.
class FacingQuery {
  public:
    FacingQuery(const BallTree& a, const BallTree& b);  ///< the same: with itself
    FacingQuery(FacingQuery&&) noexcept;
    FacingQuery& operator=(FacingQuery&&) noexcept;
    ~FacingQuery();

    /// Same bytes on every instruction set. Some .5 us a vertex that faces something, as long as `distance` and the
    /// ways are not many edges long.
    /// @param distance m, >= 0 and finite
    /// @param reach m, 0..distance
    /// @param apart of one with itself: per vertex, ascending, those whose triangles it does not face; else null
    /// @param mostWork units; what turns out to cost more is given up, after up to 40 more. It is not gone on with:
    /// half of the answer would be wrong about the sides
    void find(const SurfaceWay& a, const SurfaceWay& b, float distance, float reach, const IndexLists* apart,
              FacingResult& result, std::uint64_t mostWork = unlimited);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
