// Line charts: what happened over time, for a person to look at.
#pragma once

#include <string>
#include <vector>

#include <scenes/canvas.hpp>

namespace grapeshot::scenes {

struct Line {
    std::string label;
    std::vector<double> x;
    std::vector<double> y;
    Colour colour = {0.1F, 0.3F, 0.7F};
    double thickness = 1.6;  ///< pixels
};

struct Plot {
    std::string title;
    std::string xLabel;  ///< with its unit
    std::string yLabel;
    bool logY = false;  ///< values of 0 and below are left out then
    std::vector<Line> lines;
};

/// Colours that stay apart, also for the colour-blind (Okabe, Ito. 2008); index modulo their number.
[[nodiscard]] Colour seriesColour(std::size_t index);

[[nodiscard]] Canvas draw(const Plot& plot, int width = 1000, int height = 560);

}  // namespace grapeshot::scenes
