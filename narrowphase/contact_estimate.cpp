#include <grapeshot/narrowphase/contact_estimate.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/narrowphase/penetration.hpp>

namespace grapeshot {
namespace {

bool isUsable(const RegionSettings& settings) {
    return settings.spacing > 0 && std::isfinite(settings.spacing) && !std::isnan(settings.normalCone);
}

CrossingRegion containedAt(const SurfaceContact& contact) {
    CrossingRegion region;
    region.position = 0.5F * (contact.onA + contact.onB);
    region.normal = contact.normal;
    region.depth = -contact.signedDistance;
    region.probability = 1;
    region.proven = true;
    region.pair = {contact.triangleA, contact.triangleB};
    return region;
}

}  // namespace

void ContactEstimator::find(const Pose& bInA, const ContactEstimateSettings& settings, Budget budget,
                            ContactEstimate& out) {
    m_pose = bInA;
    m_settings = settings;
    m_askedContainment = false;
    m_contained.clear();
    if (isUsable(settings.regions)) {
        m_query.find(bInA, settings.crossing, budget, m_crossing);
    } else {
        m_query.forget();
        m_crossing = Crossing();
    }
    fill(out);
}

void ContactEstimator::resume(Budget budget, ContactEstimate& out) {
    m_query.resume(budget, m_crossing);
    fill(out);
}

void ContactEstimator::fill(ContactEstimate& out) {
    out.regions.clear();
    out.probability = 0;
    out.certain = m_crossing.certain;
    out.stop = m_crossing.stop;
    out.work = m_crossing.work;
    if (out.stop == StopReason::invalidInput) {
        return;
    }
    const Calibration& calibration =
        m_settings.crossing.calibration != nullptr ? *m_settings.crossing.calibration : defaultCalibration();
    groupCrossing(m_crossing.pieces, m_crossing.work, m_settings.regions, calibration, out.regions);
    const bool likely = std::ranges::any_of(out.regions, [](const auto& region) { return region.probability >= 0.5F; });
    if (!likely && m_settings.interior == Interior::solid) {
        if (!m_askedContainment) {
            m_askedContainment = true;
            containmentContacts(*m_a, *m_b, m_pose, m_contained);
        }
        std::ranges::transform(m_contained, std::back_inserter(out.regions), containedAt);
    }
    // Triangles in one plane, that look the same way, prove it without a region: they push no way.
    const bool intersect = !m_crossing.pieces.empty() && m_crossing.pieces.front().proven();
    if (intersect || std::ranges::any_of(out.regions, &CrossingRegion::proven)) {
        out.probability = 1;
    } else if (!out.certain) {
        // Before the first step nothing is known.
        const float probability =
            out.work == 0 ? 0.5F : probabilityAfter(calibration, std::max(m_crossing.rate, 1e-30F), out.work);
        out.probability = std::clamp(probability, 1e-6F, 1 - 1e-6F);
    }
}

}  // namespace grapeshot
