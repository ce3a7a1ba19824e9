// What the demo shows: the scene, side by side, with its paths, and the time per step.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <scenes/canvas.hpp>

#include "shot.hpp"

namespace grapeshot::cannonball {

using Paths = std::vector<std::vector<Eigen::Vector3d>>;  ///< per ball, one point per step

/// One frame of one or two shots beside each other, each under its title.
struct Panel {
    const Shot* shot = nullptr;
    std::size_t frame = 0;
    std::string title;
};
[[nodiscard]] scenes::Canvas sideBySide(const std::vector<Panel>& panels);

/// The end of the first shot with the balls' paths in all shots.
[[nodiscard]] scenes::Canvas withPaths(const Shot& shot, const std::vector<Paths>& pathsOfShots,
                                       const std::string& title);

/// Time of each step of the shots, on a logarithmic axis.
[[nodiscard]] scenes::Canvas stepTimes(const std::vector<const Shot*>& shots);

}  // namespace grapeshot::cannonball
