// What the last step cost, and what could not be done.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/narrowphase/method.hpp>
#include <grapeshot/plugin/precision.hpp>

class btCollisionDispatcher;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// One pair of shapes in one step. Children of compound shapes are pairs of their own.
struct PairStatistics {
    int proxyA = -1;  ///< ids of the two broadphase proxies (btBroadphaseProxy::getUid), -1 if the body has none
    int proxyB = -1;
    std::uint64_t work = 0;            ///< calls of a 16-wide kernel
    std::uint64_t slice = 0;           ///< most that it was given, work units; `unlimited` without a budget
    std::uint32_t age = 0;             ///< steps in a row cut short without more than the mandatory slice
    std::uint32_t candidates = 0;      ///< leaf pairs tested
    int contacts = 0;                  ///< points given to Bullet
    int speculative = 0;               ///< of these, ahead of time
    int manifolds = 0;                 ///< non-empty ones
    std::uint32_t droppedRegions = 0;  ///< beyond Settings::maxManifolds
    float deepest = 0;                 ///< largest penetration, margins included, m; 0 if none
    bool certain = false;              ///< nothing within the distance (refreshed: that touches) was left out
    Method method = Method::adb;       ///< whose trees served it: adb or scf
    bool sampled = false;              ///< by scf, whose features were tracked and sampled
    bool leftToAdb = false;            ///< asked of scf, but for want of ball trees served by adb
    /// Of sampled pairs, soft ones too: 95 % bound on the contact cells (see MissEstimate) that were not found;
    /// infinite if the budget ended before it was known.
    double missBound = 0;
    bool traversed = false;                      ///< the trees were traversed, candidates collected anew
    bool refreshed = false;                      ///< known contacts were brought up to date, see Settings::reuse
    StopReason stop = StopReason::invalidInput;  ///< invalidInput: refused, no contacts
    bool soft = false;                           ///< one of them is a soft body; `speculative`: what would pass through
};

/// Pairs of two kinds of shapes that were taken, by BroadphaseNativeTypes, the smaller one first.
struct TakenPairs {
    int shapeTypeA = 0;
    int shapeTypeB = 0;
    std::uint64_t algorithms = 0;  ///< made
};

/// Sums over the pairs of the step, and counts since registration.
///
/// Bullet has no sign for the begin of a step that an algorithm could see. A step begins here when a pair comes by for
/// the second time; so each substep of stepSimulation is one, and what is read after stepSimulation is the last. A step
/// in which every pair is new, or none is processed, is not told from the one before. A Dispatcher knows better: see
/// there when its frames begin; each is a step here.
struct StepStatistics {
    std::uint64_t step = 0;  ///< counts from 1
    std::uint64_t work = 0;
    std::uint64_t candidates = 0;
    int contacts = 0;
    int speculative = 0;
    int manifolds = 0;
    std::uint64_t droppedRegions = 0;
    float deepest = 0;                  ///< m
    int traversals = 0;                 ///< pairs whose trees were traversed
    int refreshed = 0;                  ///< pairs that had moved too little to be searched
    int tracked = 0;                    ///< pairs that scf served
    int sampled = 0;                    ///< of these, pairs whose features were tracked and sampled
    int leftToAdb = 0;                  ///< pairs asked of scf that adb served: a stand-in for a mesh in the making
    int degraded = 0;                   ///< pairs cut short by their budget: they go on in the next step
    std::uint32_t longestWait = 0;      ///< largest age of a pair, steps
    int refused = 0;                    ///< pairs without an answer: unusable mesh, pose that is not rigid or no number
    std::string lastRefusal;            ///< why, in words; kept from the last step that had one
    std::vector<PairStatistics> pairs;  ///< in the order Bullet processed them

    // Of a Dispatcher alone; children of compounds and all dispatches of the frame included.
    std::uint64_t budget = unlimited;  ///< Settings::frameBudget.work
    std::uint64_t building = 0;        ///< of `work`, what went into trees
    std::uint64_t mandatory = 0;       ///< work units that were given out whatever the budget
    int dispatches = 0;                ///< of pair caches, in this frame

    // Since registration.
    std::uint64_t fallbacks = 0;  ///< pairs handed to Bullet's GImpact algorithm, for want of any other
    std::uint64_t refusals = 0;   ///< sum of `refused`
    std::uint64_t queries = 0;    ///< pairs of contactTest and contactPairTest; not counted in steps
    std::uint64_t queryWork = 0;
    std::uint64_t algorithms = 0;   ///< made
    std::vector<TakenPairs> taken;  ///< the same by kinds of shapes, in the order in which they came
};

/// Of a dispatcher that registerAlgorithms knows; of any other, all zero. The reference stays valid until
/// unregisterAlgorithms, the values until the next step.
[[nodiscard]] const StepStatistics& statistics(const btCollisionDispatcher* dispatcher) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
