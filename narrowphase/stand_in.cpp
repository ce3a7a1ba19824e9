#include <grapeshot/narrowphase/stand_in.hpp>

#include <algorithm>

#include <grapeshot/narrowphase/contact_estimate.hpp>

namespace grapeshot {

std::uint64_t standInContact(const MeshModel& a, const MeshModel& b, const Pose& bInA, const RegionSettings& regions,
                             float mostDepth, std::uint64_t work, std::vector<SurfaceContact>& out) {
    thread_local ContactEstimate estimate;
    ContactEstimateSettings settings;
    settings.regions.spacing = regions.spacing;
    settings.interior = Interior::surface;
    ContactEstimator(a, b).find(bInA, settings, {.work = work}, estimate);
    const auto best =
        std::max_element(estimate.regions.begin(), estimate.regions.end(),
                         [](const auto& left, const auto& right) { return left.probability < right.probability; });
    if (best != estimate.regions.end() && estimate.probability >= (work < standInWork ? 0.9F : 0.5F)) {
        const float depth = std::clamp(best->depth / 2, 0.0F, mostDepth);
        out.push_back({best->position - 0.5F * depth * best->normal, best->position + 0.5F * depth * best->normal,
                       best->normal, -depth, noTriangle, noTriangle});
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
