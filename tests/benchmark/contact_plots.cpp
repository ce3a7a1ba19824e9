#include "contact_plots.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <scenes/plot.hpp>

namespace grapeshot::bench {

void drawContactPlots(const std::vector<ContactCurve>& curves, const std::string& name, const std::string& folder) {
    std::filesystem::create_directories(folder);
    std::string fileName = name;
    std::ranges::replace_if(
        fileName, [](char c) { return c == ' ' || c == ',' || c == '%' || c == '.'; }, '_');
    const auto drawOne = [&](const char* file, const char* title, const char* yLabel, bool logY,
                             std::vector<double> ContactCurve::*values) {
        scenes::Plot plot{std::string(title) + ": " + name, "log2 of us per query", yLabel, logY, {}};
        for (const ContactCurve& curve : curves) {
            scenes::Line line{curve.name, {}, curve.*values, scenes::seriesColour(plot.lines.size()), 2};
            std::ranges::transform(curve.us, std::back_inserter(line.x), [](double us) { return std::log2(us); });
            plot.lines.push_back(std::move(line));
        }
        scenes::draw(plot, 1000, 560)
            .save(std::filesystem::path(folder) / ("contacts_" + std::string(file) + "_" + fileName + ".png"));
    };
    drawOne("position", "Position of regions, 90th percentile of the error", "% of the box's diagonal", true,
            &ContactCurve::position);
    drawOne("normal", "Normal of regions, 90th percentile of the error", "degrees", true, &ContactCurve::normal);
    drawOne("recall", "True regions that are reported", "%", false, &ContactCurve::recall);
}

}  // namespace grapeshot::bench
