#include "limits_scan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <grapeshot/adb/detail/pair_walk.hpp>
#include <grapeshot/adb/detail/whole_pair.hpp>
#include <grapeshot/core/rate_bound.hpp>

#include "fit_meshes.hpp"
#include "forecasts.hpp"
#include "gates.hpp"
#include "pose_sets.hpp"
#include "stopped.hpp"

namespace grapeshot::bench {

namespace {

constexpr std::size_t mostSteps = 96;
/// The errors that the gates allow are upper limits of this confidence on the meshes for fitting; among them are thin
/// knots, which are the hardest.
constexpr double gateConfidence = 0.95;

/// What an estimate without limits goes through on one pose.
struct Course {
    std::optional<float> ofWholes;     ///< before the first step, where the whole surfaces say anything
    std::vector<float> probabilities;  ///< after each step that left it uncertain
    bool collides = false;
    double exactWork = 0;  ///< that is left when it hands over after the default number of steps
};

/// Limits are given as log2 of the odds, p / (1 - p).
float probabilityOf(double log2Odds) {
    return static_cast<float>(1 / (1 + std::exp2(-log2Odds)));
}

/// In steps of the exact traversal: a step of the estimate takes about as long as two, what comes before the first
/// about as long as one and a half.
constexpr double estimateStep = 2;
constexpr double beforeFirstStep = 1.5;

struct Cost {
    double errorPercent = 0, worstErrorPercent = 0;
    double errors = 0, poses = 0;
    double time = 1;  ///< in steps of the exact traversal, geometric mean over the meshes
};

Cost costOf(const std::vector<std::vector<Course>>& meshes, float acceptAt, float rejectAt, bool hybrid) {
    const std::size_t steps = hybrid ? DecideSettings().estimateSteps : mostSteps;
    const detail::Doubt doubt = hybrid ? detail::doubtBetween(rejectAt, acceptAt) : detail::Doubt{1, 0};
    const auto beyond = [&](float p) { return p >= acceptAt || p <= rejectAt; };
    Cost cost;
    for (const std::vector<Course>& mesh : meshes) {
        double errors = 0;
        double time = 0;
        for (const Course& course : mesh) {
            time += beforeFirstStep;
            if (course.ofWholes && beyond(*course.ofWholes)) {
                errors += (*course.ofWholes >= acceptAt) != course.collides ? 1 : 0;
                continue;
            }
            const auto end = course.probabilities.begin() +
                             static_cast<std::ptrdiff_t>(std::min(steps, course.probabilities.size()));
            const auto stop = std::find_if(course.probabilities.begin(), end,
                                           [&](float p) { return beyond(p) || (p > doubt.from && p < doubt.to); });
            time += estimateStep * static_cast<double>(std::min(end, stop + 1) - course.probabilities.begin());
            if (stop != end && beyond(*stop)) {
                errors += (*stop >= acceptAt) != course.collides ? 1 : 0;
            } else if (hybrid) {
                time += course.exactWork;
            }
        }
        const auto n = static_cast<double>(mesh.size());
        cost.time *= std::pow(time / n, 1 / static_cast<double>(meshes.size()));
        cost.errors += errors;
        cost.poses += n;
        cost.errorPercent += 100 * errors / n / static_cast<double>(meshes.size());
        cost.worstErrorPercent = std::max(cost.worstErrorPercent, 100 * errors / n);
    }
    return cost;
}

bool keeps(const Cost& cost, double percent) {
    return cost.errorPercent <= percent && 100 * upperRate(static_cast<std::uint64_t>(cost.errors),
                                                           static_cast<std::uint64_t>(cost.poses), gateConfidence) <=
                                               percent;
}

std::vector<Course> coursesOf(const Tree& tree, const std::vector<Pose>& poses) {
    DecideSettings handingOver = anytimeSettings();
    handingOver.estimateSteps = DecideSettings().estimateSteps;
    Query query(tree, tree);
    Query hybrid(tree, tree);
    detail::PairWalk walk(tree, tree);
    std::vector<Course> courses;
    for (const Pose& pose : poses) {
        Course& course = courses.emplace_back();
        if (walk.start(pose)) {
            const float squaredDistance = walk.squaredDistanceOfWholes();
            if (squaredDistance >= detail::leastEstimated) {
                course.ofWholes = probabilityOfWholes(defaultCalibration(), squaredDistance);
            }
        }
        Decision decision = query.decide(pose, anytimeSettings(), {.work = 1});
        while (!decision.certain && course.probabilities.size() < mostSteps) {
            course.probabilities.push_back(decision.collides ? decision.probability : 1 - decision.probability);
            decision = query.resume({.work = 1});
        }
        decision = query.resume({});
        course.collides = decision.collides;
        const auto steps =
            static_cast<double>(std::min<std::size_t>(course.probabilities.size(), DecideSettings().estimateSteps));
        course.exactWork = std::max(0.0, static_cast<double>(hybrid.decide(pose, handingOver).work) - steps);
    }
    return courses;
}

}  // namespace

std::vector<report::Row> scanLimits(const Options& options) {
    const int perMesh = options.poses.value_or(options.quick ? 240 : 24'000);
    std::vector<std::vector<Course>> meshes;
    std::vector<std::vector<Course>> grazing;
    for (const NamedMesh& mesh : fitMeshes(options.quick)) {
        const Tree tree = build(mesh.mesh.view());
        meshes.push_back(coursesOf(tree, zachmannSet(tree, perMesh, options.seed + 2).poses));
        grazing.push_back(coursesOf(tree, grazingSet(tree, std::max(6, perMesh / 10), options.seed + 3).poses));
    }
    std::vector<report::Row> rows;
    const auto addBest = [&](const std::string& method, const Gate& gate, bool hybrid) {
        Cost best;
        best.time = INFINITY;
        float acceptAt = 1;
        float rejectAt = 0;
        for (double accept = 0.5; accept <= 14; accept += 0.25) {
            for (double reject = 0.5; reject <= 14; reject += 0.25) {
                const Cost cost = costOf(meshes, probabilityOf(accept), probabilityOf(-reject), hybrid);
                if (cost.time >= best.time || !keeps(cost, gate.errorPercent)) {
                    continue;
                }
                if (!hybrid || keeps(costOf(grazing, probabilityOf(accept), probabilityOf(-reject), hybrid),
                                     hybridGrazingGate.errorPercent)) {
                    best = cost;
                    acceptAt = probabilityOf(accept);
                    rejectAt = probabilityOf(-reject);
                }
            }
        }
        report::Row& row = rows.emplace_back();
        row.scenario = "limits";
        row.mesh = "all " + std::to_string(meshes.size());
        row.method = method;
        row.n = meshes.size() * meshes.front().size();
        row.work = {{"exactSteps", best.time}};
        row.measured = {{"acceptAt", static_cast<double>(acceptAt)},
                        {"rejectAt", static_cast<double>(rejectAt)},
                        {"errorPct", best.errorPercent},
                        {"worstErrorPct", best.worstErrorPercent}};
    };
    for (const EstimateSetting& estimate : estimateSettings) {
        addBest(estimate.name, estimate.gate, false);
    }
    addBest("hybrid", hybridShuffledGate, true);
    return rows;
}

}  // namespace grapeshot::bench
