// The table of the paper: collisions found after so many steps.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace grapeshot::bench {

inline constexpr std::array publishedSteps{1, 4, 7, 10, 15, 16};

struct PublishedRecall {
    std::string method;  ///< with hierarchy, without hierarchy
    std::vector<int> steps;
    std::vector<double> foundPercent;
};

/// @throws Error badFile
[[nodiscard]] std::vector<PublishedRecall> readPublishedRecall(const std::string& file);

}  // namespace grapeshot::bench
