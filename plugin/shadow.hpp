// Ours beside whatever a program has now, in its own scene, before it switches.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <grapeshot/plugin/precision.hpp>
#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionObject;
class btCollisionWorld;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// What one side found of one pair of bodies, in one pose. A contact counts if the shapes touch, margins included.
struct ShadowSide {
    int contacts = 0;
    double depth = 0;                  ///< of the deepest, m; 0 if there is none
    std::chrono::nanoseconds time{0};  ///< of its processCollision
};

struct ShadowPair {
    const btCollisionObject* first = nullptr;
    const btCollisionObject* second = nullptr;
    ShadowSide theirs, ours;
    /// Where both touch: our depth less theirs, m; and the angle between the normals of their deepest contact and of
    /// ours nearest to it, rad, 0..pi.
    double depthDifference = 0;
    double normalAngle = 0;
    std::uint64_t work = 0;  ///< ours, in work units
    bool degraded = false;   ///< ours was cut short by Settings::pairBudget, or had only a stand-in for a mesh
    bool refused = false;    ///< ours has no answer: an unusable mesh, a pose that is not rigid
};

/// Sums over pairs; each pair counts once in each step observed.
struct ShadowTotals {
    std::uint64_t steps = 0;
    std::uint64_t pairs = 0;
    std::uint64_t bothTouch = 0, onlyTheirs = 0, onlyOurs = 0, neither = 0;
    std::uint64_t theirContacts = 0, ourContacts = 0;
    double largestDepthDifference = 0;  ///< absolute value, m
    double meanDepthDifference = 0;     ///< absolute value, where both touch, m
    double largestNormalAngle = 0;      ///< rad
    double meanNormalAngle = 0;         ///< where both touch, rad
    std::chrono::nanoseconds theirTime{0}, ourTime{0};
    std::uint64_t work = 0;
    std::uint64_t degraded = 0, refused = 0;
    std::uint64_t fallbacks = 0;  ///< pairs that Bullet's GImpact algorithm got from us for want of any other
};
/// A few lines for people. Allocates.
[[nodiscard]] std::string toText(const ShadowTotals& totals);

/// Runs our algorithms on the pairs of a world in which something else, or other settings, decide. Call `observe` after
/// each step. For the pairs with a mesh that registerAlgorithms would take over (children of compounds included), it
/// computes the contacts of the present poses twice, into manifolds of its own that no solver sees: with the
/// dispatcher's own tables, and with ours. Both keep their memory from step to step, as they do in a simulation.
///
/// Changes nothing: no body, no manifold, no table, no statistics of the world; callbacks for contacts are not called.
/// With or without it, the simulation is the same bit by bit: of a mesh whose tree a Dispatcher is building in slices,
/// both sides see what stands in for it, too. What it costs comes on top of the step: about the
/// narrowphase of such pairs twice. An algorithm of the program's own is run a second time, on other manifolds. Not for
/// two threads at once. A program's btCollisionObjects and its collision configuration must live while `observe` runs,
/// not longer.
class Shadow {
  public:
    explicit Shadow(const Settings& settings = {});
    ~Shadow();
    Shadow(const Shadow&) = delete;
    Shadow& operator=(const Shadow&) = delete;

    /// nullPointer; badArgument: the world's dispatcher is no btCollisionDispatcher; badSettings: those of the
    /// constructor are; outOfMemory: the step is not counted. Pairs that the program's near callback has never let pass
    /// or that needsCollision holds back (two sleeping bodies) are left out.
    Status observe(btCollisionWorld* world) noexcept;

    /// Of the last step observed, in the order of the world's pairs.
    [[nodiscard]] const std::vector<ShadowPair>& pairs() const noexcept;
    /// Since the beginning or `reset`.
    [[nodiscard]] const ShadowTotals& totals() const noexcept;
    void reset() noexcept;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
