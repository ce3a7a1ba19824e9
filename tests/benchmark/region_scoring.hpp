// How good contact regions are against the exact ones: which were found, how far they are off, and what force and
// torque they would make.
#pragma once

#include <span>
#include <vector>

#include <grapeshot/narrowphase/crossing_regions.hpp>

#include "scoring.hpp"

namespace grapeshot::bench {

using Regions = std::vector<CrossingRegion>;

/// What a pair's regions do to A as springs of unit stiffness: the sum of depth times normal, and its moment about a
/// point.
struct Wrench {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< m
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< m^2
};
[[nodiscard]] Wrench wrenchOf(const Regions& regions, const Eigen::Vector3f& about);

/// Two regions match if they are no farther apart than the spacing and their normals are within the cone: as members of
/// one region would have to be.
[[nodiscard]] bool match(const CrossingRegion& one, const CrossingRegion& other, const RegionSettings& settings);

/// Collects what comes of a method over many poses.
class RegionScore {
  public:
    /// @param size of the meshes (diagonal of the box), m: positions are told in percent of it
    RegionScore(const RegionSettings& settings, double size) : m_settings(settings), m_size(size) {}

    /// @param found all regions with their probabilities; those with at least one half count as reported
    /// @param depths of the true regions by measure, m; 0 where there is none
    void add(const Regions& truth, std::span<const float> depths, const Regions& found, const Eigen::Vector3f& about);

    [[nodiscard]] double recallPercent() const;        ///< true regions that a reported one matches
    [[nodiscard]] double precisionPercent() const;     ///< reported regions that match a true one
    [[nodiscard]] double lengthRecallPercent() const;  ///< the same, weighted by the length of the curve

    // Of the matched ones, the nearest match of each.
    std::vector<double> positionPercent;  ///< of the size
    std::vector<double> normalDegrees;
    std::vector<double> depthRatio;  ///< to the measured depth
    // Of all poses with a force.
    std::vector<double> forceDegrees, forceRatio, torqueDegrees, torqueRatio;
    std::vector<Forecast> forecasts;  ///< of every region that is not proven: is it one?

  private:
    RegionSettings m_settings;
    double m_size;
    double m_true = 0, m_trueFound = 0, m_length = 0, m_lengthFound = 0, m_reported = 0, m_reportedTrue = 0;
};

}  // namespace grapeshot::bench
