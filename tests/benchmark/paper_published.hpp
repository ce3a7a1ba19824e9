// What the paper's plots say.
#pragma once

#include <string>
#include <vector>

namespace grapeshot::bench {

/// One curve of figures 12 and 13.
struct PublishedCurve {
    std::string figure;   ///< fig12_time_ms or fig13_error_pct
    std::string model;    ///< car, lock, pipes
    std::string variant;  ///< number of polygons of the ADB-tree, or DOP and that number
    std::vector<double> distances;
    std::vector<double> values;
};

/// @throws Error badFile
[[nodiscard]] std::vector<PublishedCurve> readPublished(const std::string& file);

/// @throws Error badFile if there is none
[[nodiscard]] const PublishedCurve& find(const std::vector<PublishedCurve>& curves, const std::string& figure,
                                         const std::string& model, const std::string& variant);

/// Of both at the same distances: the first divided by the second.
[[nodiscard]] PublishedCurve quotient(const PublishedCurve& dividend, const PublishedCurve& divisor);

}  // namespace grapeshot::bench
