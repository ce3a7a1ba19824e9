// The contacts of two surfaces, or of one with itself, from step to step: kept while they last, looked for by sampling
// where they are likely and where they are not, at a price that does not depend on the size of the meshes.
//
// This work is based on:
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
// Laks Raghupathi et al. An Intestinal Surgery Simulator: Real-Time Collision Processing and Visualization. TVCG 2004
#pragma once

#include <Eigen/Core>
#include <cstddef>
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
#include <grapeshot/scf/miss_estimate.hpp>
#include <grapeshot/scf/motion.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot {

enum class TrackMode {
    exact,       ///< all pairs of triangles within the distance. Not tracked: nothing is remembered
    resolution,  ///< every pair of cells of the size `spacing` is proven to be clear, or has a contact reported
    budget,      ///< what the budget allows, with a bound on what was missed
};

struct TrackSettings {
    TrackMode mode = TrackMode::budget;
    float maxDistance = 0;  ///< m, >= 0: triangles at most so far apart are in contact
    /// m, > 0: of contacts nearer to each other than about this on both surfaces one is kept, whatever the size of the
    /// triangles. A mesh that is coarser has one per pair of triangles.
    float spacing = 0.05F;
    /// m, >= 0: pairs that were in contact, or nearly, are followed up to so much beyond maxDistance.
    float followDistance = 0;
    /// m, >= 0, a body with itself: pairs of triangles whose centroids were at most so far apart at rest are left out,
    /// and pairs that share a vertex.
    float exclusion = 0;
    /// Pieces of each surface between whose pairs the sampling is divided, 16..4096. More: a finer search, a finer unit
    /// for what is missed, and a longer traversal before the first sample.
    std::uint32_t frontCells = 512;
    /// At most so many dives a step, even if there is budget left for more.
    std::uint32_t maxDives = 1024;
    /// Share of the budget, after what must be, that goes into the uniform sample for the bound, 0..1. With 0 there is
    /// no bound.
    float auditShare = 0.25F;
    /// Of the traversal of a step it is remembered how far what it left out was apart, and that is not looked at again
    /// before the surfaces may have come so near (see `Displacement`). Finds the same in `exact` mode, no less in the
    /// others. Of no effect while displacements are unknown.
    bool keepFront = true;
    /// Steps, >= 0, budget mode: pairs of triangles that could be in contact within so many steps, if the surfaces go
    /// on to come nearer by as much as in this one (TrackResult::nearer), are looked for and followed as well, so that
    /// contacts are known when they begin. At most `spacing` beyond maxDistance. Of no effect while displacements are
    /// unknown, and with 0.
    float lookAhead = 0;
    /// m, > 0, of `sweep`: ... and so much more, so that it ends; see ImpactSettings::tolerance.
    float tolerance = 1e-5F;
    std::uint64_t seed = 1;
    std::uint64_t pair = 0;  ///< of the two bodies, see `pairKey`
};

/// Everything at `time`, in the common frame, in metres. Of a body with itself triangleA < triangleB.
struct TrackedContact {
    TrianglePair pair;
    Eigen::Vector3f onA = Eigen::Vector3f::Zero();  ///< closest points; the middle of the intersection if overlapping
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();
    /// Unit, on B pointing to A. Of overlapping triangles B's normal, whichever side A came from.
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();
    float signedDistance = 0;   ///< minus the translation that parts the two triangles if overlapping
    std::uint8_t featureA = 6;  ///< 0..2 corner, 3..5 edge, 6 face (see DistanceBatch)
    std::uint8_t featureB = 6;
    bool overlapping = false;
    std::uint32_t age = 0;  ///< steps since it was found
    /// Of a continuous step: when the two triangles are first in contact, 0..1; else 1, its end.
    float time = 1;
};

struct TrackResult {
    std::vector<TrackedContact> contacts;
    /// Not in contact, but ahead (TrackSettings::lookAhead): where none of `contacts` is within about the spacing.
    std::vector<TrackedContact> ahead;
    /// exact: all are listed. resolution, budget: every pair of cells (of the size `spacing`; of the front) is clear or
    /// has one listed. As true as a given stretch bound. Of a continuous step: in all of it, and the cells are those of
    /// the size `spacing` in budget mode, too.
    bool certain = false;
    StopReason stop = StopReason::invalidInput;
    /// With invalidInput: topologyChanged, notFinite, notRigid or badSetting. Nothing is listed then, and the tracker
    /// is as before the step.
    std::optional<Fault> fault;
    std::uint64_t work = 0;
    /// Budget mode only. Of a continuous step not of cells of the front, but of pairs of pieces and of triangles that
    /// were still open when the search had used its share; missed are those with a contact whose cells have none.
    MissEstimate miss;
    float stretchA = 1;  ///< given or measured; 0 where balls were fitted anew
    float stretchB = 1;
    std::uint32_t carried = 0;  ///< tracked pairs that the budget left untested: kept, not listed
    std::uint32_t tracked = 0;  ///< pairs that are kept for the next step
    std::uint32_t dives = 0;    ///< random ones
    /// m: by how much a point of one surface may have come nearer to one of the other since the step before; infinite
    /// if that is not known, or was not asked for.
    float nearer = std::numeric_limits<float>::infinity();
    std::uint32_t frontKept = 0;    ///< pairs of pieces that were known from the step before and not looked at again
    std::uint32_t frontOpened = 0;  ///< that were known and had to be looked at again
};

/// A value: a copy goes on by itself, with the same results. Same settings, inputs and work budgets: same bytes, on
/// every instruction set. The trees must stay where they are. Not for two threads at once. A step does not throw (but
/// for memory). One that was moved from may only be copied, assigned to or destroyed.
class Tracker {
  public:
    /// Of two bodies, of one mesh perhaps.
    Tracker(const BallTree& a, const BallTree& b);
    /// Of a body with itself.
    explicit Tracker(const BallTree& body);
    Tracker(const Tracker&);
    Tracker& operator=(const Tracker&);
    Tracker(Tracker&&) noexcept;
    Tracker& operator=(Tracker&&) noexcept;
    ~Tracker();

    /// One step of the scene. The budget counts calls of 16-wide kernels (and looks at up to sixteen neighbours); it
    /// may be exceeded by at most 40, what two leaves need. Only positions that are read are checked for being finite.
    /// The first step after a change of `spacing` or `frontCells` cuts the surfaces, O(n).
    void step(const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings, Budget budget,
              TrackResult& out);
    [[nodiscard]] TrackResult step(const SurfaceState& a, const SurfaceState& b, const TrackSettings& settings,
                                   Budget budget = {});
    /// Of a body with itself. @pre made of one body, and the other two of two: asserted
    void step(const SurfaceState& body, const TrackSettings& settings, Budget budget, TrackResult& out);
    [[nodiscard]] TrackResult step(const SurfaceState& body, const TrackSettings& settings, Budget budget = {});

    /// The same, continuously: contacts are the pairs of triangles that come within the distance at any moment of the
    /// step, each when it first does, so that nothing passes through anything. exact: all of them. resolution: of every
    /// pair of cells (of the size `spacing`) one, nearly the first. budget: those that were tracked, then by time; what
    /// is open when the budget ends is sampled. `followDistance`, `frontCells` and `maxDives` are of no effect. The
    /// budget may be exceeded by at most 20. A step in which a body turns by more than a quarter of a radian is
    /// searched in parts. Discrete and continuous steps may follow each other.
    void sweep(const SurfaceMotion& a, const SurfaceMotion& b, const TrackSettings& settings, Budget budget,
               TrackResult& out);
    [[nodiscard]] TrackResult sweep(const SurfaceMotion& a, const SurfaceMotion& b, const TrackSettings& settings,
                                    Budget budget = {});
    /// Of a body with itself. @pre made of one tree, and the other two of two: asserted
    void sweep(const SurfaceMotion& body, const TrackSettings& settings, Budget budget, TrackResult& out);
    [[nodiscard]] TrackResult sweep(const SurfaceMotion& body, const TrackSettings& settings, Budget budget = {});

    /// Forgets all pairs; the count of steps goes on.
    void clear();
    [[nodiscard]] std::uint64_t steps() const;

    /// All that the next steps depend on beside their arguments, little-endian.
    [[nodiscard]] std::vector<std::byte> save() const;
    /// In place of the state. @throws Error badFile (not what `save` has written, or damaged), topologyChanged (of
    /// other meshes); the tracker is then as before
    void load(std::span<const std::byte> bytes);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
