// The descent into two trees, step by step, for those who look at what it sees: fits and tuning.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <grapeshot/adb/detail/estimate.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>
#include <grapeshot/core/budget.hpp>

namespace grapeshot::detail {

/// Owns the memory that a descent works on.
class PairWalk {
  public:
    PairWalk(const Tree& a, const Tree& b);
    PairWalk(const PairWalk&) = delete;
    PairWalk& operator=(const PairWalk&) = delete;

    /// False if the balls around the meshes are apart. Then there is nothing to walk.
    bool start(const Pose& bInA);
    /// One more step of the estimate from the root on.
    EstimateEnd estimate(const RateFormula& formula);
    [[nodiscard]] const Cut& cut() const { return m_cut; }
    [[nodiscard]] float tunedRate() const { return detail::tunedRate(m_descent, m_cut); }
    /// The entry of the cut with the largest rate, after one step or more.
    [[nodiscard]] SidePair likeliest() const;
    /// D^2 of the two whole surfaces in the last pose.
    [[nodiscard]] float squaredDistanceOfWholes() const { return m_squaredDistance; }
    /// What a pair of the last pose consists of.
    int children(SidePair pair, ChildPair (&out)[16]) const;
    /// Do any triangles below two sides intersect, in the last pose? Exact. Nothing if that takes more than so many
    /// units.
    [[nodiscard]] std::optional<bool> overlaps(SidePair pair, std::uint64_t units);
    [[nodiscard]] bool overlaps(SidePair pair) { return *overlaps(pair, unlimited); }
    /// The same for all pairs of the cut, likeliest first, as a query does it after the estimate. `steps`: taken.
    [[nodiscard]] bool overlapsBelowCut(std::uint64_t& steps);

  private:
    Descent m_descent;
    StackStorage m_stack;
    Cut m_cut;
    std::vector<Side> m_cutA, m_cutB;
    alignas(64) float m_rates[cutCapacity] = {};
    float m_squaredDistance = 0;
    const Tree* m_a;
    const Tree* m_b;
};

}  // namespace grapeshot::detail
