// Two solids in each other: their cuts, and what is said of their depths.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include <grapeshot/core/topology.hpp>
#include <grapeshot/scf/depth.hpp>

#include <scenes/shapes.hpp>
#include <support/depth_oracle.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {

struct SolidPair {
    SolidPair(const scenes::Mesh& meshA, const scenes::Mesh& meshB)
        : a(buildBallTree(meshA.view())), b(buildBallTree(meshB.view())), tracker(a, b), query(a, b) {}
    SolidPair(const SolidPair&) = delete;
    SolidPair& operator=(const SolidPair&) = delete;

    /// All that overlap.
    [[nodiscard]] std::vector<TrackedContact> cutsAt(const Pose& bInA) {
        TrackSettings exact;
        exact.mode = TrackMode::exact;
        std::vector<TrackedContact> cuts = tracker.step(rigidState(poseA), rigidState(bInA), exact).contacts;
        std::erase_if(cuts, [](const TrackedContact& contact) { return !contact.overlapping; });
        return cuts;
    }
    /// Cold.
    [[nodiscard]] DepthResult measure(const Pose& bInA, std::span<const TrackedContact> cuts,
                                      const Budget& budget = {}) {
        DepthMemory none;
        return follow(bInA, cuts, none, budget);
    }
    [[nodiscard]] DepthResult follow(const Pose& bInA, std::span<const TrackedContact> cuts, DepthMemory& memory,
                                     const Budget& budget = {}) {
        return query.measure(rigidState(poseA), rigidState(bInA), cuts, {}, settings, memory, budget);
    }

    BallTree a, b;
    Tracker tracker;
    DepthQuery query;
    DepthSettings settings;
    Pose poseA;
};

inline std::vector<TrianglePair> pairsOf(std::span<const TrackedContact> contacts) {
    std::vector<TrianglePair> pairs;
    for (const TrackedContact& contact : contacts) {
        pairs.push_back(contact.pair);
    }
    return pairs;
}

/// Those whose deepest vertex, or whose crossing, lies in a true region.
inline std::vector<std::size_t> regionsOf(const DepthResult& result, const TrueRegion& truth) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < result.regions.size(); ++i) {
        const DepthRegion& region = result.regions[i];
        const bool isIn =
            region.source == DepthSource::crossing
                ? std::ranges::any_of(truth.cuts,
                                      [&](const TrianglePair& pair) { return pair.triangleB == region.triangle; })
                : std::ranges::binary_search(region.source == DepthSource::vertexOfA ? truth.insideA : truth.insideB,
                                             region.vertex);
        if (isIn) {
            found.push_back(i);
        }
    }
    return found;
}

}  // namespace grapeshot::test
