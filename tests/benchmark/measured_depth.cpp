#include "measured_depth.hpp"

#include <algorithm>

#include <grapeshot/narrowphase/detail/cut_depth.hpp>
#include <grapeshot/narrowphase/detail/surface_cut.hpp>

namespace grapeshot::bench {

std::vector<float> measuredDepths(const MeshModel& a, const MeshModel& b, const Pose& bInA, const Regions& regions,
                                  const RegionSettings& settings) {
    Query query(a.tree, b.tree);
    const Contacts contacts = query.contacts(bInA, {});
    detail::SurfaceCuts cuts;
    detail::findCuts(a, b, bInA, contacts.pairs, settings.spacing, cuts);
    std::vector<float> depths(regions.size(), 0);
    std::vector<SurfaceContact> columns;
    for (const detail::SurfaceCut& cut : cuts.cuts) {
        columns.clear();
        detail::measureColumns(a, b, bInA, cut, cuts.piecesOf(cut), 0.5F * settings.spacing, columns);
        float deepest = 0;
        for (const SurfaceContact& column : columns) {
            deepest = std::max(deepest, -column.signedDistance);
        }
        for (std::size_t r = 0; r < regions.size(); ++r) {
            const bool near = (regions[r].position - cut.center.cast<float>()).norm() <= settings.spacing;
            if (near && regions[r].normal.dot(cut.normal.cast<float>()) >= settings.normalCone) {
                depths[r] = std::max(depths[r], deepest);
            }
        }
    }
    return depths;
}

}  // namespace grapeshot::bench
