// Which contacts belong together: the one definition that both methods, the benchmarks and the oracle use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

struct RegionSettings {
    /// Two contacts are neighbours if their points are at most this far apart on both surfaces, m, > 0.
    float spacing = 0.1F;
    /// ... and their normals are within this angle of the region's first (deepest) contact's normal: its cosine.
    float normalCone = 0.866F;
};

/// A set of contacts connected along both surfaces within the spacing and the normal cone.
struct ContactRegion {
    std::vector<std::uint32_t> members;                 ///< indices of the contacts, deepest first
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();  ///< mean, unit, on B pointing to A, A's frame
    Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< mean of the middles between the witness points, A's frame, m
    float depth = 0;                                   ///< largest penetration, m; negative while separated
};

/// Deepest contact seeds a region, neighbours join, and theirs; and so on with what is left. Deterministic for a
/// given order of input; regions deepest first. O(n) expected (hash grid).
[[nodiscard]] std::vector<ContactRegion> groupRegions(std::span<const SurfaceContact> contacts,
                                                      const RegionSettings& settings);

}  // namespace grapeshot
