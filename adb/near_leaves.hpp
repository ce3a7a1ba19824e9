// All leaf pairs of two trees near each other, in one go, and the boxes of what else is not far.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/pose.hpp>

namespace grapeshot {

struct NearLeaves {
    std::vector<LeafPair> pairs;  ///< whose boxes are within maxDistance: those of Query::leafPairs, in its order
    /// Boxes of what the descent passed by, of A and of B, each in its mesh's frame, m: whatever is within `reach` of
    /// the other mesh is in one of them or in a leaf of `pairs`. Lower above upper: there is nothing.
    Eigen::Vector3f lower[2], upper[2];
    std::uint64_t work = 0;
};

/// Keeps its memory from call to call.
class NearLeafSearch {
  public:
    NearLeafSearch();
    ~NearLeafSearch();
    NearLeafSearch(const NearLeafSearch&) = delete;
    NearLeafSearch& operator=(const NearLeafSearch&) = delete;

    /// Distances in m, 0 <= maxDistance <= reach; work as Query::leafPairs without a budget: `reach` costs nothing.
    /// False for a pose that is no number or not rigid, and for distances out of range; `out` is empty then.
    bool find(const Tree& a, const Tree& b, const Pose& bInA, float maxDistance, float reach, NearLeaves& out);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
