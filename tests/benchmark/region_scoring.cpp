#include "region_scoring.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::bench {

namespace {

double degreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

/// Direction and magnitude against the truth, if the truth has any.
void compareVectors(const Eigen::Vector3d& truth, const Eigen::Vector3d& found, std::vector<double>& degrees,
                    std::vector<double>& ratio) {
    constexpr double opposite = 180;
    if (!(truth.norm() > 0)) {
        return;
    }
    ratio.push_back(found.norm() / truth.norm());
    degrees.push_back(found.norm() > 0 ? degreesBetween(truth, found) : opposite);
}

}  // namespace

Wrench wrenchOf(const Regions& regions, const Eigen::Vector3f& about) {
    Wrench wrench;
    for (const CrossingRegion& region : regions) {
        const Eigen::Vector3d force = double{region.depth} * region.normal.cast<double>();
        wrench.force += force;
        wrench.torque += (region.position - about).cast<double>().cross(force);
    }
    return wrench;
}

bool match(const CrossingRegion& one, const CrossingRegion& other, const RegionSettings& settings) {
    return (one.position - other.position).norm() <= settings.spacing &&
           one.normal.dot(other.normal) >= settings.normalCone;
}

void RegionScore::add(const Regions& truth, std::span<const float> depths, const Regions& found,
                      const Eigen::Vector3f& about) {
    Regions reported = found;
    takeRegions(grapeshot::Answer::mostLikely, {}, reported);
    for (std::size_t t = 0; t < truth.size(); ++t) {
        const CrossingRegion& region = truth[t];
        m_true += 1;
        m_length += double{region.length};
        const CrossingRegion* nearest = nullptr;
        const auto distance = [&](const CrossingRegion& other) { return (other.position - region.position).norm(); };
        for (const CrossingRegion& other : reported) {
            if (match(region, other, m_settings) && (nearest == nullptr || distance(other) < distance(*nearest))) {
                nearest = &other;
            }
        }
        if (nearest == nullptr) {
            continue;
        }
        m_trueFound += 1;
        m_lengthFound += double{region.length};
        positionPercent.push_back(100 * double{distance(*nearest)} / m_size);
        normalDegrees.push_back(degreesBetween(region.normal.cast<double>(), nearest->normal.cast<double>()));
        if (depths[t] > 0) {
            depthRatio.push_back(double{nearest->depth} / double{depths[t]});
        }
    }
    const auto isTrue = [&](const CrossingRegion& region) {
        return std::ranges::any_of(truth, [&](const CrossingRegion& one) { return match(one, region, m_settings); });
    };
    m_reported += static_cast<double>(reported.size());
    m_reportedTrue += static_cast<double>(std::ranges::count_if(reported, isTrue));
    for (const CrossingRegion& region : found) {
        if (!region.proven) {
            forecasts.push_back({double{region.probability}, isTrue(region)});
        }
    }
    const Wrench exact = wrenchOf(truth, about);
    const Wrench made = wrenchOf(reported, about);
    compareVectors(exact.force, made.force, forceDegrees, forceRatio);
    compareVectors(exact.torque, made.torque, torqueDegrees, torqueRatio);
}

double RegionScore::recallPercent() const {
    return 100 * m_trueFound / m_true;
}
double RegionScore::precisionPercent() const {
    return 100 * m_reportedTrue / m_reported;
}
double RegionScore::lengthRecallPercent() const {
    return 100 * m_lengthFound / m_length;
}

}  // namespace grapeshot::bench
