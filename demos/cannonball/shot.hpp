// One shot from start to end, and what is worth keeping of it.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <report/report.hpp>
#include <scenes/cannonball.hpp>

namespace grapeshot::cannonball {

struct Shot {
    explicit Shot(const scenes::CannonballSettings& settings);

    /// One step; keeps the record and the poses.
    void advance();

    scenes::CannonballScene scene;
    std::vector<scenes::StepRecord> records;
    std::vector<scenes::Frame> frames;  ///< frames[0] is the start, frames[i] after step i
    std::size_t firstImpact = 0;        ///< the step in which a ball first lost a tenth of its speed; 0: none did
};

/// Where a ball's centre went, one point per frame.
[[nodiscard]] std::vector<Eigen::Vector3d> path(const Shot& shot, std::size_t ball);

/// True penetration, judged by the independent oracle in every `stride`-th frame.
struct Depths {
    double deepest = 0;  ///< m
    double p99 = 0;      ///< of the pairs that touch, m
};
[[nodiscard]] Depths depths(const Shot& shot, std::size_t stride);

/// How far the plausible paths part: root mean square distance of the final points from their mean, m; per ball.
[[nodiscard]] std::vector<double> spreads(const std::vector<std::vector<std::vector<Eigen::Vector3d>>>& pathsOfShots);

}  // namespace grapeshot::cannonball
