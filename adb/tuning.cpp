#include <grapeshot/adb/tuning.hpp>

#include <cmath>
#include <optional>
#include <vector>

#include <grapeshot/adb/certification_poses.hpp>
#include <grapeshot/adb/detail/pair_walk.hpp>
#include <grapeshot/adb/detail/require_setting.hpp>

namespace grapeshot {
namespace {

constexpr std::uint64_t tuningSeed = 1;
constexpr int watchedSteps[] = {1, 2, 4};   // later ones are too seldom in doubt to count
constexpr std::uint64_t mostUnits = 4'000;  // of an exact answer
constexpr float mostOctaves = 4;
constexpr int halvings = 7;  // to a sixteenth of an octave
/// So many poses seen to be right as they are; or a few poses of a mesh that is hardly ever in doubt would move it far.
constexpr double prior = 1;
struct Step {
    float rate;
    std::uint64_t steps;
    bool collides;
};
std::vector<Step> watch(const Tree& tree, int poses, const RateFormula& formula) {
    std::vector<Step> seen;
    detail::PairWalk walk(tree, tree);
    for (const Pose& pose : certificationPoses(tree, tree, static_cast<std::size_t>(poses), tuningSeed)) {
        if (!walk.start(pose)) {
            continue;
        }
        const std::optional<bool> collides = walk.overlaps(detail::sidePair(0, 0), mostUnits);
        if (!collides) {
            continue;
        }
        std::uint64_t taken = 0;
        for (const std::uint64_t steps : watchedSteps) {
            detail::EstimateEnd end = detail::EstimateEnd::budget;
            for (; taken < steps && end == detail::EstimateEnd::budget; ++taken) {
                end = walk.estimate(formula);
            }
            if (end != detail::EstimateEnd::budget || !(walk.cut().rate > 0)) {
                break;  // certain
            }
            seen.push_back({walk.cut().rate, steps, *collides});
        }
    }
    return seen;
}

/// Where the probabilities of the first step, or of the later ones, come true in sum. Their excess over the truth is
/// the derivative of the log-likelihood by the octaves, up to a factor, as far as the table is a logistic curve; and it
/// rises with the octaves.
float octavesFor(const std::vector<Step>& seen, const Calibration& calibration, bool first) {
    float low = -mostOctaves;
    float high = mostOctaves;
    for (int i = 0; i < halvings; ++i) {
        const float octaves = 0.5F * (low + high);
        const float factor = std::exp2(octaves);
        double excess = prior * octaves;
        for (const Step& step : seen) {
            if ((step.steps == 1) == first) {
                excess += probabilityAfter(calibration, factor * step.rate, step.steps) - (step.collides ? 1.0 : 0.0);
            }
        }
        (excess > 0 ? high : low) = octaves;
    }
    return 0.5F * (low + high);
}

}  // namespace

void tune(Tree& tree, int poses, const Calibration& calibration) {
    detail::requireSetting(poses >= 0 && poses <= 10'000, "BuildSettings::tuningPoses", poses);
    tree.rateOctaves = 0;
    tree.firstRates = 1;
    if (poses == 0 || tree.nodes.empty()) {
        return;
    }
    const std::vector<Step> seen = watch(tree, poses, calibration.formula);
    if (!seen.empty()) {
        tree.rateOctaves = octavesFor(seen, calibration, false);
        tree.firstRates = std::exp2(octavesFor(seen, calibration, true) - tree.rateOctaves);
    }
}

}  // namespace grapeshot
