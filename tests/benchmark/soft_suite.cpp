#include "soft_suite.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#include "soft_scenarios.hpp"

namespace grapeshot::bench {

namespace {

struct SoftScenario {
    std::string_view name;
    bool quick;  ///< of a quick run that names none
    void (*run)(const Options&, report::Report&);
};

template <int triangles>
void sheets(const Options& options, report::Report& results) {
    runSheets(triangles, options, results);
}

template <int triangles>
void balls(const Options& options, report::Report& results) {
    runBalls(triangles, options, results);
}

template <int triangles>
void fold(const Options& options, report::Report& results) {
    runFold(triangles, options, results);
}

constexpr std::array softScenarios{
    SoftScenario{"sheets_1k", true, sheets<1'000>},
    SoftScenario{"sheets_10k", false, sheets<10'000>},
    SoftScenario{"sheets_70k", false, sheets<70'000>},
    SoftScenario{"balls_1k", true, balls<1'000>},
    SoftScenario{"balls_10k", false, balls<10'000>},
    SoftScenario{"balls_70k", false, balls<70'000>},
    SoftScenario{"torus", true,
                 [](const Options& options, report::Report& results) { runClothOnTorus(1, options, results); }},
    SoftScenario{"small_torus", true,
                 [](const Options& options, report::Report& results) { runClothOnTorus(0.1, options, results); }},
    SoftScenario{"fold", true, fold<512>},
    SoftScenario{"fold_10k", false, fold<10'000>},
    SoftScenario{"fold_70k", false, fold<70'000>},
    SoftScenario{"demos", false, runSoftDemos},
    SoftScenario{"shots", true, runSoftShots},
};

}  // namespace

report::Report runSoftSuite(const Options& options) {
    report::Report results{.suite = "soft", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    const std::vector<std::string>& wanted = options.scenarios;
    for (const std::string& name : wanted) {
        if (std::ranges::find(softScenarios, name, &SoftScenario::name) == softScenarios.end()) {
            std::string message = "--scenario: '" + name + "' is none of";
            for (const SoftScenario& scenario : softScenarios) {
                message.append(" ").append(scenario.name);
            }
            throw std::invalid_argument(message);
        }
    }
    for (const SoftScenario& scenario : softScenarios) {
        if (wanted.empty() ? scenario.quick || !options.quick : std::ranges::count(wanted, scenario.name) > 0) {
            scenario.run(options, results);
        }
    }
    return results;
}

}  // namespace grapeshot::bench
