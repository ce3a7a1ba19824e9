#include "anytime_plots.hpp"

#include <cmath>
#include <filesystem>

#include <scenes/plot.hpp>

namespace grapeshot::bench {

void drawAnytimePlots(const std::vector<Series>& all, const std::string& scenario, const std::string& folder) {
    const std::filesystem::path where(folder);
    std::filesystem::create_directories(where);

    scenes::Plot reliability{"How often a probability comes true: " + scenario,
                             "P(they collide), as answered",
                             "share that collides",
                             false,
                             {{"right", {0, 1}, {0, 1}, scenes::Colour::Constant(0.6F), 2.2}}};
    constexpr std::uint64_t mostSteps = 8;  // of more hardly any answer is in doubt
    constexpr std::size_t enough = 10;      // fewer than so many show nothing but chance
    for (const Stopped& at : all.front().at) {
        if (at.steps > mostSteps) {
            continue;
        }
        scenes::Line line{
            std::to_string(at.steps) + " steps", {}, {}, scenes::seriesColour(reliability.lines.size()), 1.6};
        for (const Bin& bin : binsOfEqualWidth(at.forecasts, 20)) {
            if (bin.count >= enough) {
                line.x.push_back(bin.probability);
                line.y.push_back(bin.share);
            }
        }
        reliability.lines.push_back(std::move(line));
    }
    scenes::draw(reliability, 700, 640).save(where / ("anytime_reliability_" + scenario + ".png"));

    scenes::Plot error{"Wrong answers after so many steps: " + scenario, "log2 of steps", "% of queries", true, {}};
    for (const Series& series : all) {
        scenes::Line line{series.method, {}, {}, scenes::seriesColour(error.lines.size()), 1.6};
        line.thickness = error.lines.empty() ? 2.6 : 1.4;
        for (const Stopped& at : series.at) {
            line.x.push_back(std::log2(static_cast<double>(at.steps)));
            line.y.push_back(score(at.forecasts).errorPercent);
        }
        error.lines.push_back(std::move(line));
    }
    scenes::draw(error, 1400, 560).save(where / ("anytime_error_" + scenario + ".png"));
}

}  // namespace grapeshot::bench
