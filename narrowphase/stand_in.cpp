#include <grapeshot/narrowphase/stand_in.hpp>

#include <algorithm>

#include <grapeshot/narrowphase/contact_estimate.hpp>

namespace grapeshot {
namespace {

constexpr std::size_t mostStandIns = 4;

}  // namespace

std::uint64_t standInContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA, const RegionSettings& regions,
                              float mostDepth, std::uint64_t work, std::vector<SurfaceContact>& out) {
    thread_local ContactEstimate estimate;
    ContactEstimateSettings settings;
    settings.regions.spacing = regions.spacing;
    settings.interior = Interior::surface;
    ContactEstimator(a, b).find(bInA, settings, {.work = work}, estimate);
    if (estimate.probability < (work < standInWork ? 0.9F : 0.5F)) {
        return estimate.work;
    }
    std::ranges::stable_sort(estimate.regions, std::ranges::greater(), &CrossingRegion::probability);
    std::size_t count = 0;
    for (const CrossingRegion& region : estimate.regions) {
        if (count == mostStandIns || (count > 0 && region.probability < 0.5F)) {
            break;
        }
        ++count;
        const float depth = std::clamp(region.depth / 2, 0.0F, mostDepth);
        out.push_back({region.position - 0.5F * depth * region.normal, region.position + 0.5F * depth * region.normal,
                       region.normal, -depth, noTriangle, noTriangle});
    }
    return estimate.work;
}

void dropStandIns(ContactSet& set) {
    for (RegionSlot& slot : set.slots) {
        int kept = 0;
        for (int i = 0; i < slot.count; ++i) {
            const PersistentPoint& point = slot.points[static_cast<std::size_t>(i)];
            if (point.triangleA != noTriangle || point.triangleB != noTriangle) {
                slot.points[static_cast<std::size_t>(kept++)] = point;
            }
        }
        for (int i = kept; i < slot.count; ++i) {
            slot.points[static_cast<std::size_t>(i)] = PersistentPoint();
        }
        slot.count = kept;
    }
}

}  // namespace grapeshot
