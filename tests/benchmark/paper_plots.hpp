// Our curves beside the published ones.
#pragma once

#include <string>
#include <vector>

#include "paper_published.hpp"

namespace grapeshot::bench {

struct MeasuredCurves {
    std::string model;
    std::vector<double> distances;
    std::vector<double> errorPercent;
    std::vector<double> adbUs, dopUs;
    std::vector<double> speedUp;  ///< exact DOP-tree / ADB
};

/// paper_error.png, paper_time.png, paper_speed_up.png. @throws Error badFile
void drawPaperPlots(const std::vector<MeasuredCurves>& measured, const std::vector<PublishedCurve>& published,
                    const std::string& folder);

}  // namespace grapeshot::bench
