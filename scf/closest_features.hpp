// The closest features of two surfaces that are apart, or of one with itself, wherever they are now.
//
// This work is based on:
// Sean Quinlan. Efficient Distance Computation between Non-Convex Objects. ICRA 1994 (branch and bound on spheres)
// Ming Lin, John Canny. A fast algorithm for incremental distance calculation. ICRA 1991 (from the features before)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot {

/// Everything in the common frame, in metres. Of a body with itself triangleA < triangleB.
struct FeaturePair {
    TrianglePair pair;
    Eigen::Vector3f onA = Eigen::Vector3f::Zero();  ///< closest points; the middle of the intersection if overlapping
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();
    /// Unit, on B pointing to A. Of overlapping triangles B's normal, whichever side A came from.
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
    float signedDistance = 0;   ///< minus the translation that parts the two triangles if overlapping
    std::uint8_t featureA = 6;  ///< 0..2 corner, 3..5 edge, 6 face (see DistanceBatch)
    std::uint8_t featureB = 6;
    bool overlapping = false;
};

struct ClosestSettings {
    /// m, >= 0: what is farther apart is of no interest; much cheaper than to find out how far. Finite if `most` > 1.
    float maxDistance = std::numeric_limits<float>::infinity();
    std::uint32_t most = 1;  ///< pairs to list, at least 1
    /// m, >= 0: of pairs whose points are nearer to each other than this on both surfaces the nearest alone is listed;
    /// with 0 all are.
    float spacing = 0;
    /// m, >= 0, a body with itself: pairs of triangles whose centroids were at most so far apart at rest are left out,
    /// and pairs that share a vertex.
    float exclusion = 0;
};

struct ClosestResult {
    std::vector<FeaturePair> pairs;  ///< nearest first
    /// No pair that is not listed (nor left out by `spacing`) is nearer than this, m: proven, as far as a given stretch
    /// bound is true. So the distance of the surfaces lies in [atLeast, pairs[0].signedDistance].
    float atLeast = 0;
    /// The pairs are the nearest ones, or all within maxDistance. Of surfaces that overlap: one overlapping pair is
    /// listed, whichever; how deep they are in each other is not this query's (see depth.hpp).
    bool certain = false;
    StopReason stop = StopReason::invalidInput;
    /// With invalidInput: topologyChanged, notFinite, notRigid or badSetting. Nothing is listed then.
    std::optional<Fault> fault;
    std::uint64_t work = 0;
};

/// A query for one pair of bodies; keeps its memory from call to call and no more, so that every answer depends on its
/// arguments alone: the same bytes on every instruction set. The trees must stay where they are. Not for two threads.
class ClosestQuery {
  public:
    ClosestQuery(const BallTree& a, const BallTree& b);
    /// Of a body with itself.
    explicit ClosestQuery(const BallTree& body);
    ClosestQuery(ClosestQuery&&) noexcept;
    ClosestQuery& operator=(ClosestQuery&&) noexcept;
    ~ClosestQuery();

    /// Nearest pieces first, until what waits is farther than what was found. A larger budget gives no larger distance
    /// and no smaller `atLeast`. The budget counts calls of 16-wide kernels; it may be exceeded by at most 64. Only
    /// positions that are read are checked for being finite.
    /// @param known pairs that were closest a step before, say: they and their neighbourhood are looked at first. They
    /// change the price, and what a small budget finds; pairs that do not exist are passed over
    [[nodiscard]] ClosestResult find(const SurfaceState& a, const SurfaceState& b, const ClosestSettings& settings = {},
                                     std::span<const TrianglePair> known = {}, Budget budget = {});
    /// Of a body with itself. @pre made of one tree, and the other of two: asserted
    [[nodiscard]] ClosestResult find(const SurfaceState& body, const ClosestSettings& settings = {},
                                     std::span<const TrianglePair> known = {}, Budget budget = {});

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
