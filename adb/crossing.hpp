// The curve in which two surfaces cross, from coarse to exact: pieces of it with place, direction and expected length,
// of pairs of tree nodes while they are coarse and of pairs of triangles in the end.
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003 (best
// first over pairs of nodes that know how their polygons are distributed; there it says yes or no)
// Luis Santalo. Integral Geometry and Geometric Probability. 1976, (15.20): mean length of intersection curves
// Bruce Walter et al. Lightcuts. SIGGRAPH 2005 (a cut is refined where its error is largest)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot {

/// A piece of the curve; everything in A's frame.
struct CurvePiece {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< mean, m
    /// Normal of B minus normal of A, mean: the way A is pushed. Length 0 (they cancel, or nothing is known of them) to
    /// 2.
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float length = 0;  ///< expected, m; 0 for triangles that only touch or lie in one plane
    float extent = 0;  ///< about so far from `position` the piece may be, root mean square, m
    float slope = 0;   ///< tangent of half the angle between the surfaces, inside both
    /// Rate at which two such pieces of surface meet (see Calibration); the rates of pieces add up. Infinite if proven.
    float rate = 0;
    TrianglePair pair;  ///< the two triangles, if proven

    [[nodiscard]] bool proven() const { return pair.triangleA != noTriangle; }
};

struct CrossingSettings {
    /// The shortest pieces are not told of, as long as they make up no more than this part of the expected length,
    /// 0..1: 0 tells all, 1 none. Proven ones always are.
    float leaveOut = 0.05F;
    /// Null: the default one. Must stay where it is as long as the query is used.
    const Calibration* calibration = nullptr;
};

/// What is known of the curve.
struct Crossing {
    /// Proven ones first; when it is certain, in ascending order of their triangles. The same on every instruction set.
    std::vector<CurvePiece> pieces;
    /// Sum over all pieces that are not proven, also those that are not told of. (But when there are more than 768, one
    /// at a time is refined to its end at once; what is left of that one is neither here nor among the pieces.)
    float rate = 0;
    bool certain = false;  ///< all pieces are proven and none is missing
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;  ///< work units since `find`, resumed parts included
};

/// Finds the curve of two trees step by step: the piece with the largest product of expected length and extent is
/// replaced by what the children of its two nodes have; two leaves are tested exactly. Can be stopped after any number
/// of steps (units) and resumed; more steps bring the pieces nearer to the curve, and the end is exact. About 0.1 us a
/// step. Copyable: a copy resumes on its own; one that was moved from may only be copied, assigned to or destroyed.
/// Keeps references to both trees, which must stay where they are and unchanged while it is resumed. Not for two
/// threads at once. Never throws (but for memory).
class CrossingQuery {
  public:
    CrossingQuery(const Tree& a, const Tree& b);
    CrossingQuery(const CrossingQuery&);
    CrossingQuery& operator=(const CrossingQuery&);
    CrossingQuery(CrossingQuery&&) noexcept;
    CrossingQuery& operator=(CrossingQuery&&) noexcept;
    ~CrossingQuery();

    /// `out` is overwritten and its memory kept. Without any limit it goes to the end at once, depth first. A pose that
    /// is not finite or not rigid, or a setting out of its range: StopReason::invalidInput.
    void find(const Pose& bInA, const CrossingSettings& settings, Budget budget, Crossing& out);
    /// Goes on where `find` or `resume` stopped, with more pieces proven, and writes all of them anew.
    /// StopReason::invalidInput if there is nothing to resume.
    void resume(Budget budget, Crossing& out);
    /// Then there is nothing to resume.
    void forget();

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
