#include "fit_suite.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include <grapeshot/adb/detail/pair_walk.hpp>
#include <grapeshot/adb/query.hpp>
#include <grapeshot/adb/tuning.hpp>
#include <support/poses.hpp>

#include "fit_meshes.hpp"
#include "rate_fit.hpp"
#include "region_fit.hpp"
#include "table_fit.hpp"

namespace grapeshot::bench {

namespace {

constexpr int distances = 12;
/// What orders the walk before there is a formula; anything near will do.
constexpr RateFormula firstGuess{-0.4F, -0.65F, 0.57F};
constexpr std::uint32_t longestWalk = 96;
/// Of the poses in which contact regions are watched, as parts of the box's diagonal: mostly penetrations.
constexpr double regionGaps[] = {-0.08, -0.05, -0.03, -0.015, -0.005, 0.004};
constexpr int tuningRounds = 3;

/// Children of the last of one to twelve steps, three in ten of them.
void samplePairs(const Tree& tree, const std::vector<Pose>& poses, test::Random& random,
                 std::vector<PairSample>& samples) {
    detail::PairWalk walk(tree, tree);
    for (const Pose& pose : poses) {
        if (!walk.start(pose)) {
            continue;
        }
        const std::uint64_t steps = random.bits() % 12;
        detail::EstimateEnd end = detail::EstimateEnd::budget;
        for (std::uint64_t i = 0; i < steps && end == detail::EstimateEnd::budget; ++i) {
            end = walk.estimate(firstGuess);
        }
        if (end != detail::EstimateEnd::budget || walk.cut().count == 0) {
            continue;
        }
        const detail::SidePair pair = steps == 0 ? detail::sidePair(0, 0) : walk.likeliest();
        if (detail::bothLeaves(pair)) {
            continue;
        }
        detail::ChildPair children[16];
        const int count = walk.children(pair, children);
        for (int i = 0; i < count; ++i) {
            if (random.unit() < 0.3) {
                samples.push_back({children[i].squaredDistance, children[i].length, walk.overlaps(children[i].pair)});
            }
        }
    }
}

using Seen = std::vector<std::pair<float, bool>>;
struct Tables {
    std::vector<Seen> wholes;  ///< of each mesh
    Seen bySteps[Calibration::stepRows];
    Seen afterwards[Calibration::afterRows];
};

/// Of the meshes' curves, at each knot the one nearest to one half; one half if they lie on both sides of it.
Calibration::Row leastSure(const std::vector<Seen>& meshes) {
    Calibration::Row least{};
    Calibration::Row most{};
    least.fill(1);
    for (const Seen& seen : meshes) {
        const Calibration::Row row = fitRow(seen);
        for (std::size_t knot = 0; knot < row.size(); ++knot) {
            least[knot] = std::min(least[knot], row[knot]);
            most[knot] = std::max(most[knot], row[knot]);
        }
    }
    for (std::size_t knot = 0; knot < least.size(); ++knot) {
        least[knot] = std::clamp(0.5F, least[knot], most[knot]);
    }
    return least;
}

/// The rate after every step of each pose, and what came of it.
void watch(const Tree& tree, const std::vector<Pose>& poses, const RateFormula& formula, Tables& tables) {
    detail::PairWalk walk(tree, tree);
    for (const Pose& pose : poses) {
        if (!walk.start(pose)) {
            continue;
        }
        const bool collides = walk.overlaps(detail::sidePair(0, 0));
        const float squaredDistance = walk.squaredDistanceOfWholes();
        if (squaredDistance > 0) {
            tables.wholes.back().emplace_back(1 / (squaredDistance * squaredDistance), collides);
        }
        for (std::uint32_t step = 1; step <= longestWalk; ++step) {
            if (walk.estimate(formula) != detail::EstimateEnd::budget || walk.cut().rate <= 0) {
                break;  // certain
            }
            tables.bySteps[Calibration::rowOf(step)].emplace_back(walk.tunedRate(), collides);
            if (step == DecideSettings().estimateSteps) {
                std::uint64_t exactSteps = 0;
                if (walk.overlapsBelowCut(exactSteps) != collides) {
                    throw std::logic_error("the cut has lost a pair");
                }
                for (std::size_t after = 0; after < Calibration::afterRows; ++after) {
                    const std::uint64_t taken = after == 0 ? 0 : std::uint64_t{2} << after;
                    if (exactSteps > taken) {
                        tables.afterwards[after].emplace_back(walk.tunedRate(), collides);
                    }
                }
            }
        }
    }
}

template <class SeenRows, class Table>
void fillRows(const SeenRows& seen, Table& table) {
    for (std::size_t row = 0; row < table.size(); ++row) {
        // A small sample may not reach so far.
        table[row] = seen[row].empty() ? table[row == 0 ? 0 : row - 1] : fitRow(seen[row]);
    }
}

/// As `build` will, but for the mean, which belongs to the table.
void tuneAll(std::vector<Tree>& trees, const Calibration& calibration) {
    std::array<float, std::tuple_size_v<decltype(Tree::stepRates)>> octaves{};
    for (Tree& tree : trees) {
        tune(tree, BuildSettings().tuningPoses, calibration);
        for (std::size_t i = 0; i < octaves.size(); ++i) {
            octaves[i] += std::log2(tree.stepRates[i]) / static_cast<float>(trees.size());
        }
    }
    for (Tree& tree : trees) {
        for (std::size_t i = 0; i < octaves.size(); ++i) {
            tree.stepRates[i] *= std::exp2(-octaves[i]);
        }
    }
}

}  // namespace

report::Report runFitSuite(const Options& options) {
    const int perMesh = options.poses.value_or(options.quick ? 600 : 24'000);
    std::vector<Tree> trees;
    for (const NamedMesh& mesh : fitMeshes(options.quick)) {
        trees.push_back(build(mesh.mesh.view(), {.tuningPoses = 0}));
    }
    const auto posesOf = [&](const Tree& tree, std::uint64_t seed) {
        return test::zachmannPoses(tree, tree, distances, (perMesh + distances - 1) / distances, seed).poses;
    };
    test::Random random(options.seed);
    std::vector<PairSample> samples;
    for (const Tree& tree : trees) {
        samplePairs(tree, posesOf(tree, random.bits()), random, samples);
    }
    Calibration calibration;
    calibration.formula = fitRates(samples);
    calibration.poses =
        "two copies of a generated mesh, twelve centre distances from 0.2 to 1.05 of the mean bounding "
        "diameter, uniform directions and rotations; regions: the same mesh, up to 8 % of the diagonal in each other";
    // Trees are tuned to the table, and the table is fitted to tuned trees: in turn, the table last.
    Tables tables;
    for (int round = 0; round <= tuningRounds; ++round) {
        tables = Tables();
        for (const Tree& tree : trees) {
            tables.wholes.emplace_back();
            watch(tree, posesOf(tree, random.bits()), calibration.formula, tables);
        }
        if (round < tuningRounds) {
            fillRows(tables.bySteps, calibration.bySteps);
            tuneAll(trees, calibration);
        }
    }
    report::Report results{.suite = "fit", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    report::Row pairs;
    pairs.scenario = "pairs";
    pairs.mesh = "all";
    pairs.method = "rates";
    pairs.n = samples.size();
    pairs.measured = {{"logLoss", logLoss(samples, calibration.formula)},
                      {"areaUnderCurve", areaUnderCurve(samples, calibration.formula)},
                      {"constant", calibration.formula.constant},
                      {"distance", calibration.formula.distance},
                      {"length", calibration.formula.length}};
    results.rows.push_back(pairs);
    const auto fill = [&](const char* scenario, const auto& seen, auto& table) {
        fillRows(seen, table);
        for (std::size_t row = 0; row < table.size(); ++row) {
            if (seen[row].empty()) {
                continue;
            }
            report::Row line;
            line.scenario = scenario + std::to_string(row);
            line.mesh = "all";
            line.method = "table";
            line.n = seen[row].size();
            line.colliding = static_cast<double>(
                std::count_if(seen[row].begin(), seen[row].end(), [](const auto& one) { return one.second; }));
            results.rows.push_back(line);
        }
    };
    SeenRegions regions;
    for (const Tree& tree : trees) {
        for (const double gap : regionGaps) {
            watchRegions(tree, test::grazingPoses(tree, tree, std::max(1, perMesh / 120), gap, random.bits()),
                         calibration, regions);
        }
    }
    calibration.whole = leastSure(tables.wholes);
    fill("steps", tables.bySteps, calibration.bySteps);
    fill("afterwards", tables.afterwards, calibration.afterwards);
    fill("regions", regions, calibration.regions);
    results.claims.push_back({"area under the curve of the pairs' rates", pairs.measured[1].second, true, 0.9});
    if (!options.outputFile.empty()) {
        std::ofstream file(options.outputFile);
        file << toText(calibration);
        file.close();
        if (!file) {
            throw std::runtime_error("cannot write '" + options.outputFile + "'");
        }
    }
    return results;
}

}  // namespace grapeshot::bench
