// Which contacts belong together: the one definition that both methods, the benchmarks and the oracle use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot {

inline constexpr float flatCone = 0.9998F;  // cosine of 0.02 rad
inline constexpr float flatHeight = 0.01F;

struct RegionSettings {
    /// Two contacts are neighbours if their points are at most this far apart on both surfaces, m, > 0.
    float spacing = 0.1F;
    /// ... and their normals are within this angle of the region's first (deepest) contact's normal: its cosine.
    float normalCone = 0.866F;
};

/// A set of contacts connected along both surfaces within the spacing and the normal cone. Contacts of one flat support
/// are connected at any distance: those whose normals are within `flatCone` of the deepest one's and whose points on A
/// or on B lie in one plane across it, within `flatHeight` spacings. (The feet of a table stand on one floor.)
struct ContactRegion {
    std::vector<std::uint32_t> members;                 ///< indices of the contacts, deepest first
    Eigen::Vector3f normal = Eigen::Vector3f::UnitY();  ///< mean, unit, on B pointing to A, A's frame
    Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< mean of the middles between the witness points, A's frame, m
    float depth = 0;                                   ///< largest penetration, m; negative while separated
};

/// Deepest contact seeds a region, neighbours join, and theirs; and so on with what is left. Deterministic for a
/// given order of input; regions deepest first. O(n) expected (hash grid), and a look at every contact per region.
[[nodiscard]] std::vector<ContactRegion> groupRegions(std::span<const SurfaceContact> contacts,
                                                      const RegionSettings& settings);

}  // namespace grapeshot
