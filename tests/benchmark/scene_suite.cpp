#include "scene_suite.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

#include "scene_appear.hpp"
#include "scene_budget.hpp"
#include "scene_fine_pile.hpp"
#include "scene_machines.hpp"
#include "scene_methods.hpp"
#include "scene_pile.hpp"
#include "scene_rest.hpp"

namespace grapeshot::bench {

namespace {

struct Scenario {
    std::string_view name;
    bool usual;  ///< of a run that names none
    void (*run)(const Options&, report::Report&);
};

template <test::RestScene scene>
void rest(const Options& options, report::Report& results) {
    runRest(scene, options, results);
}

template <const char* name>
void machine(const Options& options, report::Report& results) {
    runMachine(name, options, results);
}
constexpr char chain[] = "chain";
constexpr char cups[] = "stacked_cups";
constexpr char gears[] = "gears";
constexpr char arch[] = "arch";

constexpr std::array scenarios{
    Scenario{"pile", true, runPile},
    Scenario{"pile_20k", false, runFinePile},
    Scenario{"pile_1k", false, runCoarsePile},
    Scenario{"pile_box", false, runBoxFloorPile},
    Scenario{"pile10", false, runSmallPile},
    Scenario{"pile200", false, runLargePile},
    Scenario{"u_on_bar", true, rest<test::RestScene::uOnBar>},
    Scenario{"cross_in_hole", true, rest<test::RestScene::crossInHole>},
    Scenario{"interlocked_tori", true, rest<test::RestScene::interlockedTori>},
    Scenario{"comb_in_rails", true, rest<test::RestScene::combInRails>},
    Scenario{"nut_on_bolt", true, rest<test::RestScene::nutOnBolt>},
    Scenario{"budget", false, runBudget},
    Scenario{chain, false, machine<chain>},
    Scenario{cups, false, machine<cups>},
    Scenario{gears, false, machine<gears>},
    Scenario{arch, false, machine<arch>},
    Scenario{"haptic_pair", false, runHapticPair},
    Scenario{"appear", false, runAppear},
    Scenario{"methods", false, runMethods},
};

}  // namespace

report::Report runSceneSuite(const Options& options) {
    report::Report results{.suite = "scene", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    const std::vector<std::string>& wanted = options.scenarios;
    for (const std::string& name : wanted) {
        if (std::ranges::find(scenarios, name, &Scenario::name) == scenarios.end()) {
            std::string message = "--scenario: '" + name + "' is none of";
            for (const Scenario& scenario : scenarios) {
                message.append(" ").append(scenario.name);
            }
            throw std::invalid_argument(message);
        }
    }
    for (const Scenario& scenario : scenarios) {
        if (wanted.empty() ? scenario.usual || options.quick : std::ranges::count(wanted, scenario.name) > 0) {
            scenario.run(options, results);
        }
    }
    return results;
}

}  // namespace grapeshot::bench
