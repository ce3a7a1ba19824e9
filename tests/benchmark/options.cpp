#include "options.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace grapeshot::bench {

namespace {

constexpr std::string_view suites[] = {"anytime", "contacts", "continuous", "decide",   "fit",   "guarantee", "paper",
                                       "scene",   "soft",     "stochastic", "tracking", "trees", "workloads"};

template <class Number>
Number number(std::string_view option, std::string_view text, Number low, Number high) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < low || value > high) {
        throw std::invalid_argument(std::string(option) + ": '" + std::string(text) + "' is no whole number from " +
                                    std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
}

double real(std::string_view option, std::string_view text, double low, double high) {
    double value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !(value >= low && value <= high)) {
        throw std::invalid_argument(std::string(option) + ": '" + std::string(text) + "' is no number from " +
                                    std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
}

InstructionSet instructionSetNamed(std::string_view text) {
    for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
        if (text == name(set)) {
            return set;
        }
    }
    throw std::invalid_argument("--isa: '" + std::string(text) + "' is not scalar, avx2 or avx512");
}

}  // namespace

Options parse(int argumentCount, const char* const* arguments) {
    Options options;
    for (int i = 1; i < argumentCount; ++i) {
        const std::string_view argument = arguments[i];
        const auto next = [&]() -> std::string_view {
            if (i + 1 >= argumentCount) {
                throw std::invalid_argument(std::string(argument) + ": a value is missing");
            }
            return arguments[++i];
        };
        const auto list = [&](std::vector<std::string>& values) {
            values.emplace_back(next());
            while (i + 1 < argumentCount && !std::string_view(arguments[i + 1]).starts_with("--")) {
                values.emplace_back(arguments[++i]);
            }
        };
        if (argument == "--help" || argument == "-h") {
            options.help = true;
        } else if (argument == "--quick") {
            options.quick = true;
        } else if (argument == "--mesh") {
            list(options.meshes);
        } else if (argument == "--scenario") {
            list(options.scenarios);
        } else if (argument == "--poses") {
            options.poses = number(argument, next(), 1, 10'000'000);
        } else if (argument == "--distances") {
            options.distances.low = real(argument, next(), 0, 10);
            options.distances.high = real(argument, next(), options.distances.low, 10);
            options.distances.step = real(argument, next(), 0.001, 10);
        } else if (argument == "--plots") {
            options.plotFolder = next();
        } else if (argument == "--repetitions") {
            options.repetitions = number(argument, next(), 1, 1000);
        } else if (argument == "--seed") {
            options.seed = number(argument, next(), std::uint64_t{0}, ~std::uint64_t{0});
        } else if (argument == "--json") {
            options.jsonFile = next();
        } else if (argument == "--output") {
            options.outputFile = next();
        } else if (argument == "--isa") {
            options.instructionSet = instructionSetNamed(next());
        } else if (options.suite.empty() &&
                   std::find(std::begin(suites), std::end(suites), argument) != std::end(suites)) {
            options.suite = argument;
        } else {
            throw std::invalid_argument("'" + std::string(argument) + "' is not understood");
        }
    }
    if (options.suite.empty() && !options.help) {
        throw std::invalid_argument("which suite?");
    }
    return options;
}

std::string usage() {
    return R"(grapeshot_bench SUITE [options]

  anytime    estimates stopped after so many steps: errors, calibration, against what else may be stopped
  contacts   contact regions stopped after so many steps, against decimated meshes at equal quality
  continuous first impacts in a step: a needle at a cloth, bodies that turn or deform; against substeps and FCL
  decide     exact and estimated yes/no against FCL, other peers and rivals; Zachmann's procedure and grazing poses
  fit        the formula and table of the ADB-trees' probabilities, on meshes that no other suite reports
  guarantee  certificates on fresh poses of unseen meshes, against the exact query; the audit on bodies in motion
  paper      the ADB-tree paper of 2003: error and time per distance, beside the published curves
  scene      Bullet scenes against GImpact, convex hulls and compounds of hulls; what a budget leaves of their quality
  soft       soft bodies in Bullet, whole step and collision apart, against Bullet's own handlers; who ends up behind whom
  stochastic the stochastic papers of 2004: collisions found after so many steps, beside the published table
  tracking   deforming surfaces: contacts tracked by scf against boxes refitted in every frame; are its bounds true?
  trees      memory, building and refit of the trees against FCL's
  workloads  yes/no as decide does not ask it: unlike pairs, smooth paths, one pose again and again; the slowest of all

  --mesh FILE...        these meshes instead of the generated ones (all but fit, scene, soft, stochastic)
  --scenario NAME...    only these scenarios (scene: see below; continuous: needle, rigid, turning,
                        deforming; soft: see below; tracking: bodies, meetings, self, front, bound, depth; workloads: work,
                        unlike, coherent, hot); limits: which limits of
                        the probability are best on the meshes for fitting; nested: only shells inside each other
                        (decide); fit: the choice of the free parameters
                        (stochastic), of the coils' settings (tracking)
  --quick               a small sample: answers are checked, times are printed but not claimed
  --poses N             poses per mesh (contacts, decide, anytime, guarantee, trees, workloads), per distance (paper),
                        frames of each bound, at most 100 of them as poses of each depth (tracking)
  --distances A B STEP  of the middles, in units of half the longest side; 0.4 2.1 0.05 (paper)
  --plots FOLDER        write the charts there (anytime, contacts, paper, stochastic)
  --repetitions N       of every timed measurement; episodes per scene (stochastic); starts (scene, budget)
  --seed S              of poses and scenes
  --isa SET             scalar, avx2 or avx512 at most
  --output FILE         write the calibration there (fit)
  --json FILE           write the rows there

Scenarios of scene, all with collision margins of 2 and 4 cm unless said otherwise; the first two lines if none is named:
  pile                                              50 bodies of 5,000 triangles, mesh floor, 12 s
  u_on_bar cross_in_hole interlocked_tori comb_in_rails nut_on_bolt
                                                    at rest for 20 s, sleeping and damping off
  pile_20k                                          50 bodies of 20,000 triangles for 40 steps, landed
  pile_1k pile_box pile10 pile200                   the pile coarser, on a box, of fewer and more bodies; 2 cm
  budget                                            the pile for full work, 1/2, 1/4, 1/8, 1/20 of it; at equal work
                                                    decimated proxies, half the rate of physics, plain round robin
  chain stacked_cups gears arch                     things that only work if contacts are where the surfaces are
  haptic_pair                                       two bodies of 20,000 triangles at 1 kHz
  appear                                            a mesh of a million triangles under falling bodies, in mid-run
  methods                                           the same scenes by each Method of the settings

Scenarios of soft, with margins of 2 and 4 cm where soft bodies meet; all if none is named:
  sheets_1k sheets_10k sheets_70k                   a sheet falls on one that is held, so many triangles each
  balls_1k balls_10k balls_70k                      two closed surfaces under pressure meet
  torus small_torus                                 cloth on a torus mesh of 1 m and of 0.1 m for 20 s
  fold fold_10k fold_70k                            folded cloth falls on itself

Exit code: 0 all claims hold, 1 a claim failed, 2 bad use.
)";
}

}  // namespace grapeshot::bench
