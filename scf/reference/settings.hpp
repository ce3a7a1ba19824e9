// What the papers leave to the application, and a switch for every part of the method.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004 (list of pairs, removal)
// Laks Raghupathi et al. An Intestinal Surgery Simulator: Real-Time Collision Processing and Visualization. TVCG 10(6),
// 2004 (two-step update, recursive spread)
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <cstdint>

namespace grapeshot::scf::reference {

/// How a pair looks for a closer one among its neighbours.
enum class Update {
    full,     ///< all neighbours x all neighbours, about 49 distances
    twoStep,  ///< one end at a time with the other held, about 14
};

/// Which of several pairs is suppressed.
enum class Redundancy {
    none,
    samePair,    ///< converged to the same two features
    neighbours,  ///< both ends equal or neighbours: the closest of them stays
};

/// When a pair is a collision.
enum class CollisionTest {
    radii,      ///< closer than the sum of the features' radii (half the longest edge around each) and `maxDistance`
    triangles,  ///< the triangles around both features come within `maxDistance`, exactly
};

struct Settings {
    int newPairs = 50;  ///< 0 to 1e6: added per step, "n"; what a step costs is linear in it
    /// 0 to 1: share of the new pairs that are drawn by how fast each feature closes in on the other body. The rest,
    /// less `hierarchyShare`, is uniform over the features.
    double velocityShare = 0;
    /// 0 to 1, both shares together at most 1: drawn in the regions that the incomplete hierarchy proposes; uniform
    /// while it proposes none.
    double hierarchyShare = 1;
    int hierarchyDepth = 5;  ///< 0 to 16: levels below the root that are looked at, no deeper than the tree was built
    /// 1 to 64: draws per end in search of a feature within the shared part of both boxes; the last one is taken.
    int tries = 1;
    /// New uniform pairs start at the coarsest level and go down as their features come close; off: all at the finest.
    bool multires = false;
    double refineAt = 1;   ///< > 0: go finer if the gap is at most this many times the sum of the radii
    double coarsenAt = 2;  ///< > refineAt: go coarser if the gap is more than this many times that of the parents
    Update update = Update::twoStep;
    int mostMoves = 1000;  ///< >= 1: moves to closer neighbours per pair and step; 1000 is to convergence
    Redundancy redundancy = Redundancy::samePair;
    bool removeFar = true;       ///< by `removeFactor` times the smallest distance + `removeOffset` times the size
    double removeFactor = 1.2;   ///< >= 1
    double removeOffset = 0.01;  ///< >= 0, of the larger body's diagonal
    CollisionTest collisionTest = CollisionTest::triangles;
    float maxDistance = 0.001F;  ///< >= 0, m: closer is a collision
    bool spread = false;         ///< a hit looks at the pairs around it, and those that hit at theirs
    int mostSpread = 10'000;     ///< >= 0: pairs looked at so per step
    int mostPairs = 100'000;     ///< >= 1: kept from step to step; the closest stay
    std::uint64_t seed = 1;
    std::uint64_t pair = 0;  ///< see RandomKey
};

/// Random pairs and neighbours alone, as Guy and Debunne, and Raghupathi.
[[nodiscard]] Settings withoutHierarchy();
/// Kimmerle: all new pairs where the incomplete hierarchy overlaps.
[[nodiscard]] Settings withHierarchy();

/// @throws Error badSetting that names the field, its value and its range
void requireUsable(const Settings& settings);

}  // namespace grapeshot::scf::reference
