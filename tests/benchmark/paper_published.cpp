#include "paper_published.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <sstream>

#include <grapeshot/core/error.hpp>

namespace grapeshot::bench {

std::vector<PublishedCurve> readPublished(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line) || !line.starts_with("figure,model,")) {
        throw Error(Fault::badFile, "no table of published curves", file);
    }
    std::vector<PublishedCurve> curves;
    for (int number = 2; std::getline(stream, line); ++number) {
        std::istringstream cells(line);
        PublishedCurve key;
        std::string distance;
        std::string value;
        std::getline(cells, key.figure, ',');
        std::getline(cells, key.model, ',');
        std::getline(cells, key.variant, ',');
        std::getline(cells, distance, ',');
        std::getline(cells, value, ',');
        auto curve = std::ranges::find_if(curves, [&](const PublishedCurve& c) {
            return c.figure == key.figure && c.model == key.model && c.variant == key.variant;
        });
        if (curve == curves.end()) {
            curve = curves.insert(curve, key);
        }
        try {
            curve->distances.push_back(std::stod(distance));
            curve->values.push_back(std::stod(value));
        } catch (const std::exception&) {
            throw Error(Fault::badFile, "'" + line + "' has no distance and value",
                        file + ":" + std::to_string(number));
        }
    }
    return curves;
}

const PublishedCurve& find(const std::vector<PublishedCurve>& curves, const std::string& figure,
                           const std::string& model, const std::string& variant) {
    const auto found = std::ranges::find_if(curves, [&](const PublishedCurve& c) {
        return c.figure == figure && c.model == model && c.variant == variant;
    });
    if (found == curves.end()) {
        throw Error(Fault::badFile, "no curve " + figure + " " + model + " " + variant, "published curves");
    }
    return *found;
}

PublishedCurve quotient(const PublishedCurve& dividend, const PublishedCurve& divisor) {
    PublishedCurve result{"ratio", divisor.model, divisor.variant, {}, {}};
    for (std::size_t i = 0; i < dividend.distances.size(); ++i) {
        for (std::size_t j = 0; j < divisor.distances.size(); ++j) {
            // Curves that end at zero time have no ratio there.
            if (std::abs(dividend.distances[i] - divisor.distances[j]) < 1e-6 && divisor.values[j] > 0.02) {
                result.distances.push_back(divisor.distances[j]);
                result.values.push_back(dividend.values[i] / divisor.values[j]);
            }
        }
    }
    return result;
}

}  // namespace grapeshot::bench
