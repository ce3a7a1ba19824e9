// When, in a step, do two surfaces first touch? Over all of the step and not only at its ends, so that nothing passes
// through anything, however thin and fast it is.
//
// This work is based on:
// Brian Mirtich. Impulse-based Dynamic Simulation of Rigid Body Systems. PhD thesis, Berkeley 1996 (conservative
// advancement)
// Min Tang, Young Kim, Dinesh Manocha. C2A: Controlled Conservative Advancement for Continuous Collision Detection of
// Polygonal Models. ICRA 2009
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/miss_estimate.hpp>
#include <grapeshot/scf/motion.hpp>

namespace grapeshot {

struct ImpactSettings {
    float maxDistance = 0;  ///< m, >= 0: triangles at most so far apart touch
    /// m, > 0: ... and so much more, so that an advancement ends. What passes by nearer than that may count as
    /// touching, and an impact is early by what it takes to cover it. Rounding makes it at least 1.5e-6 of the
    /// triangles' extents and 3e-7 of the path.
    float tolerance = 1e-5F;
    /// m, >= 0, a body with itself: pairs of triangles whose centroids were at most so far apart at rest are left out,
    /// and pairs that share a vertex.
    float exclusion = 0;
    /// Share of a limited budget that stays for the uniform sample, if the search does not end before, 0..1; of a step
    /// in parts, what is left at the last one. With 0 the sample is empty, and the bound on what was missed is all
    /// that is still open.
    float auditShare = 0.25F;
    std::uint64_t seed = 1;
    std::uint64_t pair = 0;  ///< of the two bodies, see `pairKey`
    std::uint64_t step = 0;  ///< of the scene
};

/// Everything at the time of the impact, in the common frame, in metres.
struct Impact {
    float time = 0;                                 ///< 0..1
    TrianglePair pair;                              ///< of a body with itself in no order
    Eigen::Vector3f onA = Eigen::Vector3f::Zero();  ///< closest points
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();
    /// Unit, on B pointing to A. If they overlap at the start of the step: B's normal, whichever side A came from.
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
    std::uint8_t featureA = 6;  ///< 0..2 corner, 3..5 edge, 6 face
    std::uint8_t featureB = 6;
};

struct ImpactResult {
    std::optional<Impact> impact;  ///< the earliest that was found
    /// Nothing touches before, up to the tolerance: proven, as far as a given stretch bound is true. The impact lies in
    /// [freeUntil, impact->time]; without one 1 means that there is none in this step.
    float freeUntil = 0;
    bool certain = false;  ///< freeUntil is the impact's time, or 1
    StopReason stop = StopReason::invalidInput;
    /// With invalidInput: topologyChanged, notFinite, notRigid or badSetting.
    std::optional<Fault> fault;
    std::uint64_t work = 0;
    /// If the budget ended before the search: the pairs of pieces and of triangles that were still open (`unknown`), of
    /// which a uniform sample was searched to the end. `hits`, `missed` and `missedBound` count those with an impact
    /// earlier than what had been found by then. Infinite if the part of the step that it ended in was not the last.
    MissEstimate miss;
};

/// A query for one pair of bodies; keeps its memory from call to call and no more, so that every answer depends on its
/// arguments alone: the same bytes on every instruction set. The trees must stay where they are. Not for two threads.
class ImpactQuery {
  public:
    ImpactQuery(const BallTree& a, const BallTree& b);
    /// Of a body with itself.
    explicit ImpactQuery(const BallTree& body);
    ImpactQuery(ImpactQuery&&) noexcept;
    ImpactQuery& operator=(ImpactQuery&&) noexcept;
    ~ImpactQuery();

    /// The first impact in the step. Without a limit the search goes by time, earliest pieces first, and ends with the
    /// impact, or with the proof that there is none. The budget counts calls of 16-wide kernels; it may be exceeded by
    /// at most 20. Only positions that are read are checked for being finite. A step in which a body turns by more than
    /// a quarter of a radian is searched in parts, one after the other.
    [[nodiscard]] ImpactResult find(const SurfaceMotion& a, const SurfaceMotion& b, const ImpactSettings& settings = {},
                                    Budget budget = {});
    /// Of a body with itself. @pre made of one tree, and the other of two: asserted
    [[nodiscard]] ImpactResult find(const SurfaceMotion& body, const ImpactSettings& settings = {}, Budget budget = {});

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
