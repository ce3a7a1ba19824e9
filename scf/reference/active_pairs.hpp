// Stochastic collision detection: a list of active feature pairs that follows two surfaces from step to step.
//
// This work is based on:
// Stephane Guy, Gilles Debunne. Monte-Carlo Collision Detection. INRIA RR-5136, 2004
// Laks Raghupathi et al. An Intestinal Surgery Simulator: Real-Time Collision Processing and Visualization. TVCG 10(6),
// 2004
// Stefan Kimmerle, Matthieu Nesme, Francois Faure. Hierarchy Accelerated Stochastic Collision Detection. VMV 2004
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <grapeshot/scf/reference/settings.hpp>
#include <grapeshot/scf/reference/surface.hpp>

namespace grapeshot::scf::reference {

/// Two features at a local minimum of their distance (or on the way there).
struct ActivePair {
    std::uint32_t a = 0;  ///< of A's level, or of A's coarsest if it has no such level
    std::uint32_t b = 0;
    std::uint8_t level = 0;
    /// Level 0: of the closest triangles around both features, m. Coarser: of the features' balls.
    float distance = 0;
    std::uint32_t triangleA = 0;  ///< those triangles; level 0 only
    std::uint32_t triangleB = 0;
    std::uint32_t age = 0;  ///< steps since it was drawn
    friend bool operator==(const ActivePair&, const ActivePair&) = default;
};

/// All that a step hands to the next: copy it to go back.
struct State {
    std::vector<ActivePair> pairs;  ///< by level, a, b
    std::uint64_t steps = 0;
    std::vector<Eigen::Vector3f> beforeA, beforeB;  ///< vertices of the last step; empty if it had no use for them
    friend bool operator==(const State&, const State&) = default;
};

struct Contact {
    std::uint32_t triangleA = 0;
    std::uint32_t triangleB = 0;
    float distance = 0;     ///< m
    bool bySpread = false;  ///< found from a neighbouring hit, not by an active pair
    friend bool operator==(const Contact&, const Contact&) = default;
};

/// What a step did: counts, the same on every machine.
struct Work {
    std::size_t featureDistances = 0;
    std::size_t trianglePairs = 0;
    std::size_t boxTests = 0;
    std::size_t moves = 0;
    std::size_t regions = 0;  ///< proposed by the hierarchy
    std::size_t created = 0;
    std::size_t redundant = 0;  ///< removed
    std::size_t far = 0;        ///< removed
    std::size_t spread = 0;     ///< pairs looked at around hits
    friend bool operator==(const Work&, const Work&) = default;
};

struct StepResult {
    std::vector<Contact> contacts;                           ///< by triangles, each pair once
    float closest = std::numeric_limits<float>::infinity();  ///< m, of the active pairs: an upper bound of the distance
    Work work;
    friend bool operator==(const StepResult&, const StepResult&) = default;
};

/// Adds new pairs, lets every pair go downhill, removes what is redundant or far, and reports what collides. Vertices
/// are both in one frame, m, in the order of the meshes that the surfaces were built on. O(vertices) for radii and
/// boxes, then linear in the pairs.
/// @throws Error badSetting, topologyChanged, notFinite, indexOutOfRange (a state of other surfaces); the state is
/// unchanged then
StepResult step(const Surface& a, const Surface& b, std::span<const Eigen::Vector3f> verticesA,
                std::span<const Eigen::Vector3f> verticesB, const Settings& settings, State& state);

}  // namespace grapeshot::scf::reference
