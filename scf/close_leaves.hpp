// Which leaves of two ball trees may touch where they are now: the exact traversal alone, without distances and without
// memory of other steps. For rigid bodies and others whose triangles somebody else tests.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/random.hpp>
#include <grapeshot/scf/ball_tree.hpp>
#include <grapeshot/scf/surface_state.hpp>

namespace grapeshot {

/// Two leaves, and which of their triangles have boxes (along the axes of the common frame) within the distance.
struct CloseLeaves {
    std::uint32_t leafA = 0;
    std::uint32_t leafB = 0;
    std::uint16_t row[16] = {};  ///< per triangle of leafA: a bit per triangle of leafB
};

struct CloseLeafResult {
    bool complete = false;  ///< no pair of triangles within the distance is missing
    std::uint64_t work = 0;
};

/// Keeps its memory from call to call, for whatever trees: one per thread is enough.
class CloseLeafSearch {
  public:
    CloseLeafSearch();
    ~CloseLeafSearch();
    CloseLeafSearch(const CloseLeafSearch&) = delete;
    CloseLeafSearch& operator=(const CloseLeafSearch&) = delete;

    /// Fills `out`; no two of them are the same. Those that overlap most come first, but by chance others before them:
    /// another key, another order, so that what a budget leaves out in one step is found in the next. Spends no more
    /// than the budget: one unit for sixteen pairs of balls, up to seventeen for two leaves. Nothing is found of
    /// surfaces that are not usable (see TrackResult::fault).
    /// @param maxDistance m, >= 0 and finite
    CloseLeafResult find(const BallTree& a, const SurfaceState& stateA, const BallTree& b, const SurfaceState& stateB,
                         float maxDistance, const Budget& budget, const RandomKey& order,
                         std::vector<CloseLeaves>& out);

  private:
    struct Workspace;
    std::unique_ptr<Workspace> m_workspace;
};

}  // namespace grapeshot
