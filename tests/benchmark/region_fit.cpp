#include "region_fit.hpp"

#include <algorithm>
#include <cmath>

#include "contact_methods.hpp"

namespace grapeshot::bench {

void watchRegions(const Tree& tree, const std::vector<Pose>& poses, const Calibration& calibration, SeenRegions& seen) {
    constexpr std::uint64_t budgets[] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 96};
    // A long curve pushes more than a short one, and counts more.
    constexpr float lengthOfOne = 0.05F;  // m
    constexpr std::size_t mostTimes = 100;
    CrossingQuery query(tree, tree);
    Crossing crossing;
    Regions truth;
    Regions regions;
    CrossingSettings settings;
    settings.calibration = &calibration;
    for (const Pose& pose : poses) {
        query.find(pose, settings, {}, crossing);
        groupCrossing(crossing.pieces, crossing.work, contactRegions, calibration, truth);
        for (const std::uint64_t budget : budgets) {
            query.find(pose, settings, Budget{.work = budget}, crossing);
            if (crossing.certain) {
                break;
            }
            groupCrossing(crossing.pieces, crossing.work, contactRegions, calibration, regions);
            for (const CrossingRegion& region : regions) {
                if (!region.proven && region.rate > 0) {
                    const bool isOne = std::ranges::any_of(
                        truth, [&](const CrossingRegion& one) { return match(one, region, contactRegions); });
                    const auto times = static_cast<std::size_t>(std::ceil(region.length / lengthOfOne));
                    auto& row = seen[Calibration::regionRowOf(region.steps)];
                    row.insert(row.end(), std::min<std::size_t>(times, mostTimes), {region.rate, isOne});
                }
            }
        }
    }
}

}  // namespace grapeshot::bench
