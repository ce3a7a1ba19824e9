#include "stochastic_plots.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include <scenes/plot.hpp>

namespace grapeshot::bench {

namespace {

/// Method and what the legend has room for.
constexpr std::array<std::pair<std::string_view, const char*>, 4> shown{{{"with hierarchy", "with"},
                                                                         {"without", "without"},
                                                                         {"without, velocity", "velocity"},
                                                                         {"without, multires", "multires"}}};

}  // namespace

void drawStochasticPlots(const std::vector<StochasticMethod>& methods, const std::vector<Recall>& recalls,
                         const std::vector<PublishedRecall>& published, const std::string& folder) {
    std::filesystem::create_directories(folder);
    scenes::Plot plot{"Regions of contact found: published (grey) and here, five scenes",
                      "steps since the region appeared",
                      "% of the regions of that age",
                      false,
                      {}};
    for (std::size_t i = 0; i < published.size(); ++i) {
        const PublishedRecall& row = published[i];
        plot.lines.push_back({"published, " + row.method.substr(0, row.method.find(' ')),
                              {row.steps.begin(), row.steps.end()},
                              row.foundPercent,
                              scenes::Colour::Constant(0.25F + 0.3F * static_cast<float>(i)),
                              2.2});
    }
    for (std::size_t m = 0; m < methods.size(); ++m) {
        const auto place = std::ranges::find(shown, methods[m].name, [](const auto& one) { return one.first; });
        if (place == shown.end()) {
            continue;
        }
        const auto index = static_cast<std::size_t>(place - shown.begin());
        scenes::Line line{place->second, {}, {}, scenes::seriesColour(index), 1.6};
        for (int age = 1; age <= mostAge; ++age) {
            line.x.push_back(age);
            line.y.push_back(100 * recalls[m].share(age));
        }
        plot.lines.push_back(std::move(line));
    }
    scenes::draw(plot, 1000, 480).save(std::filesystem::path(folder) / "stochastic_found.png");
}

}  // namespace grapeshot::bench
