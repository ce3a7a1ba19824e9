// Which triangles of two surfaces come near each other within a step: by a tracker, at as many moments as the motion
// wants.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/plugin/detail/surface_contacts.hpp>
#include <grapeshot/plugin/detail/thin_pairs.hpp>
#include <grapeshot/scf/box_pairs.hpp>
#include <grapeshot/scf/neighbour_list.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct NearSettings {
    float distance = 0;   ///< m, margins included
    float spacing = 0;    ///< m, > 0; with a budget: of pairs nearer to each other than this one is enough
    float exclusion = 0;  ///< m; of a body with itself, see TrackSettings
    /// Of a body with itself, without a budget: thinned by the spacing, too, see ThinPairs.
    bool thin = false;
    const IndexLists* near = nullptr;  ///< for that
    std::uint64_t seed = 1;
    std::uint64_t pair = 0;
    /// Unlimited: all pairs. Limited: those that tracking finds, but all if the bodies are too fast for that.
    Budget budget;
};

struct NearResult {
    std::uint64_t work = 0;
    bool certain = false;  ///< all pairs are listed
    StopReason stop = StopReason::invalidInput;
    std::optional<Fault> fault;
    MissEstimate miss;
    /// The bodies were too fast for the budget, which was not asked: all of the work was mandatory.
    bool isWhole = false;
};

/// Of one pair of bodies, or one with itself. The trees stay where they are.
class NearPairs {
  public:
    NearPairs(std::shared_ptr<const BallTree> a, std::shared_ptr<const BallTree> b);  ///< the same: with itself

    /// Replaces `pairs` by what may come within the distance between `last` and `after`, ascending.
    NearResult find(const SurfaceInStep& a, const SurfaceInStep& b, const NearSettings& settings,
                    std::vector<TrianglePair>& pairs);
    [[nodiscard]] const BallTree& a() const { return *m_a; }
    [[nodiscard]] const BallTree& b() const { return *m_b; }

  private:
    struct Moment;
    void look(const Moment& moment, const NearSettings& settings, NearResult& result, std::vector<TrianglePair>& pairs);
    NearResult findBeside(const SurfaceInStep& a, const NearSettings& settings, std::vector<TrianglePair>& pairs);
    NearResult findItself(const SurfaceInStep& body, const NearSettings& settings, std::vector<TrianglePair>& pairs);

    std::shared_ptr<const BallTree> m_a, m_b;
    Tracker m_tracker;
    NeighbourList m_list;  // of a body with itself
    NeighbourResult m_listed;
    ThinPairs m_thin;
    std::optional<BoxPairs> m_beside;  // what is rigid
    TrackResult m_found;
    std::vector<Eigen::Vector3f> m_positionsA, m_positionsB;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
