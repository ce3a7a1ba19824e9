// The contacts of a pair as they persist from step to step: few, spread, with names that stay.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/core/pose.hpp>
#include <grapeshot/narrowphase/contact_regions.hpp>

namespace grapeshot {

struct ContactSetSettings {
    float maxDistance = 0.06F;  ///< m: points farther apart than this are dropped on refresh
    float mergeDistance =
        0.02F;  ///< m: a new point this near to a kept one (on A) is the same one; also the least spread
    /// 1..16. Beyond it the shallowest regions share the slot of the nearest one that faces the same way; those without
    /// such a one are left out (and counted).
    int maxRegions = 8;
    /// A region keeps its slot while its normal stays within this angle (cosine) of the slot's: wider than the cone
    /// that groups, so that a region on the border does not flicker between slots.
    float keepCone = 0.7F;
    RegionSettings regions;
};

/// A contact that persists. A's point in A's frame, B's point and normal in B's frame, so that it can be re-evaluated
/// after both moved.
struct PersistentPoint {
    Eigen::Vector3f localA = Eigen::Vector3f::Zero();
    Eigen::Vector3f localB = Eigen::Vector3f::Zero();
    Eigen::Vector3f normalInB = Eigen::Vector3f::UnitY();  ///< on B pointing to A, unit
    float signedDistance = 0;                              ///< at the last refresh or merge, m
    std::uint32_t triangleA = 0xffffffffU;
    std::uint32_t triangleB = 0xffffffffU;
    std::uint32_t age = 0;  ///< steps since it appeared
};

inline constexpr int maxPointsPerRegion = 4;  // what one btPersistentManifold holds

struct RegionSlot {
    std::uint32_t id = 0;  ///< 0: free. Never reused within a set, so a host can key its own data on it.
    int count = 0;
    std::array<PersistentPoint, maxPointsPerRegion> points;
    Eigen::Vector3f normalInB = Eigen::Vector3f::UnitY();
    Eigen::Vector3f centerInA = Eigen::Vector3f::Zero();
    float depth = 0;
};

/// A value: copyable, comparable by its bytes, no pointers.
struct ContactSet {
    std::vector<RegionSlot> slots;  ///< in-use slots keep their place
    std::uint32_t nextId = 1;
    std::uint32_t droppedRegions = 0;  ///< left out because of maxRegions, in the last merge
};

[[nodiscard]] bool hasPoints(const ContactSet& set) noexcept;

/// Re-evaluates the kept points in the new pose; drops those that opened beyond maxDistance or slid sideways by more
/// than mergeDistance. True if none was dropped.
bool refresh(ContactSet& set, const Pose& bInA, const ContactSetSettings& settings);

/// Groups the step's contacts, gives each region the slot it had (by normal and place), reduces each to four points:
/// deepest, then the widest spread, preferring points already there. `complete`: the contacts are all there are, so
/// kept points without a counterpart go; otherwise they stay as evidence until refresh drops them.
void merge(ContactSet& set, std::span<const SurfaceContact> contacts, const Pose& bInA, bool complete,
           const ContactSetSettings& settings);

}  // namespace grapeshot
