// The strongest rival of an estimate: our own exact traversal, stopped, with the best guess where it had not decided.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshes.hpp"
#include "peer.hpp"

namespace grapeshot::bench {

/// Work units that the anytime answers are judged after.
inline constexpr std::array<std::uint64_t, 6> stepBudgets{1, 2, 4, 8, 16, 64};

/// Exact, and without the memory of the last pose: shuffled poses have no coherence, so that trying the last witness
/// would be a unit spent for nothing.
[[nodiscard]] inline DecideSettings exactShuffled() {
    DecideSettings settings = DecideSettings::exact();
    settings.tryWitness = false;
    return settings;
}

/// Distance of the middles of the boxes, as a part of the mean bounding diameter (of the balls about these middles).
class RelativeDistance {
  public:
    RelativeDistance(const Tree& a, const Tree& b);
    [[nodiscard]] double diameter() const { return m_diameter; }  ///< m
    [[nodiscard]] double operator()(const Pose& bInA) const {
        return static_cast<double>((bInA.rotation * m_middleB + bInA.translation - m_middleA).norm()) / m_diameter;
    }

  private:
    Eigen::Vector3f m_middleA, m_middleB;
    double m_diameter;
};

/// What is known of a pose without looking at it, and of those that the exact traversal has not decided yet: how many
/// of them collide, by distance and by the steps spent. Fitted on Zachmann's procedure with the meshes for fitting.
class StoppedPrior {
  public:
    StoppedPrior(const std::vector<NamedMesh>& meshes, int perMesh, std::uint64_t seed);
    /// P(collide) of an undecided pose after stepBudgets[budget] steps.
    [[nodiscard]] double probability(std::size_t budget, double relativeDistance) const;

  private:
    static constexpr std::size_t places = 12;
    static std::size_t placeOf(double relativeDistance);
    std::array<std::array<double, places>, stepBudgets.size()> m_share{};
};

/// Stopped after stepBudgets[budget] units; undecided: no.
[[nodiscard]] Peer stoppedPeer(const Tree& a, const Tree& b, std::size_t budget);
/// Undecided: what the prior says is likelier. It must outlive the peer.
[[nodiscard]] Peer stoppedPeer(const Tree& a, const Tree& b, std::size_t budget, const StoppedPrior& prior);

}  // namespace grapeshot::bench
