#include "region_fit.hpp"

#include <algorithm>

#include "contact_methods.hpp"

namespace grapeshot::bench {

void watchRegions(const Tree& tree, const std::vector<Pose>& poses, const Calibration& calibration, SeenRegions& seen) {
    constexpr std::uint64_t budgets[] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 96};
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
                    seen[Calibration::rowOf(region.steps)].emplace_back(
                        region.rate, std::ranges::any_of(truth, [&](const CrossingRegion& one) {
                            return match(one, region, contactRegions);
                        }));
                }
            }
        }
    }
}

}  // namespace grapeshot::bench
