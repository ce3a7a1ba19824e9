#include "paper_plots.hpp"

#include <array>
#include <filesystem>
#include <utility>

#include <scenes/plot.hpp>

namespace grapeshot::bench {

namespace {

using scenes::Line;

/// What the paper plots, in grey; ours in colour.
scenes::Colour grey(std::size_t index) {
    return scenes::Colour::Constant(0.25F + 0.22F * static_cast<float>(index));
}

constexpr std::array<std::array<const char*, 3>, 3> shownCurves{
    {{"car", "28167", "DOP28167"}, {"lock", "62023", "DOP62023"}, {"pipes", "9814", "DOP9814"}}};

Line publishedLine(const PublishedCurve& curve, const std::string& label, std::size_t index, double factor = 1) {
    Line line{label, curve.distances, curve.values, grey(index), 2.2};
    for (double& y : line.y) {
        y *= factor;
    }
    return line;
}

Line ours(const MeasuredCurves& curves, const std::vector<double>& values, const std::string& label,
          std::size_t index) {
    return {label, curves.distances, values, scenes::seriesColour(index), 1.6};
}

}  // namespace

void drawPaperPlots(const std::vector<MeasuredCurves>& measured, const std::vector<PublishedCurve>& published,
                    const std::string& folder) {
    std::filesystem::create_directories(folder);
    const std::string x = "distance of the middles (box side 2)";
    scenes::Plot error{"Wrong answers: published (grey) and here", x, "% of queries with overlapping boxes", false, {}};
    scenes::Plot time{"Time of a query: published (grey) and here", x, "us (published: hardware of 2003)", true, {}};
    scenes::Plot ratio{"Exact DOP-tree / ADB-tree, time: published (grey) and here", x, "ratio", true, {}};
    for (std::size_t i = 0; i < shownCurves.size(); ++i) {
        const auto& [model, adb, dop] = shownCurves[i];
        const PublishedCurve& adbTime = find(published, "fig12_time_ms", model, adb);
        const PublishedCurve& dopTime = find(published, "fig12_time_ms", model, dop);
        error.lines.push_back(publishedLine(find(published, "fig13_error_pct", model, adb), model, i));
        ratio.lines.push_back(publishedLine(quotient(dopTime, adbTime), model, i));
        if (i == 0) {
            time.lines.push_back(publishedLine(adbTime, std::string(model) + " ADB", 0, 1000));
            time.lines.push_back(publishedLine(dopTime, std::string(model) + " DOP", 2, 1000));
        }
    }
    for (std::size_t i = 0; i < measured.size(); ++i) {
        const MeasuredCurves& curve = measured[i];
        error.lines.push_back(ours(curve, curve.errorPercent, curve.model, i));
        ratio.lines.push_back(ours(curve, curve.speedUp, curve.model, i));
        if (i < 2) {  // of more the legend has no room
            time.lines.push_back(ours(curve, curve.adbUs, curve.model + " ADB", 2 * i));
            time.lines.push_back(ours(curve, curve.dopUs, curve.model + " DOP", 2 * i + 1));
        }
    }
    for (const auto& [plot, name] : {std::pair{&error, "paper_error.png"}, std::pair{&time, "paper_time.png"},
                                     std::pair{&ratio, "paper_speed_up.png"}}) {
        scenes::draw(*plot, 1000, 480).save(std::filesystem::path(folder) / name);
    }
}

}  // namespace grapeshot::bench
