// groupRegions without a vector per region: for callers that run every step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <grapeshot/narrowphase/contact_regions.hpp>

namespace grapeshot::detail {

/// Region r has the members [begin[r], begin[r + 1]), deepest first.
struct RegionGroups {
    struct Summary {
        Eigen::Vector3f normal;
        Eigen::Vector3f center;
        float depth;
    };
    std::vector<std::uint32_t> members;
    std::vector<std::uint32_t> begin;
    std::vector<Summary> regions;

    [[nodiscard]] std::span<const std::uint32_t> membersOf(std::size_t region) const {
        return {members.data() + begin[region], begin[region + 1] - begin[region]};
    }
};

/// As grapeshot::groupRegions. `out` is overwritten and its memory kept.
void groupRegions(std::span<const SurfaceContact> contacts, const RegionSettings& settings, RegionGroups& out);

}  // namespace grapeshot::detail
