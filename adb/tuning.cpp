// The poses are a Kronecker sequence after:
// Martin Roberts. The Unreasonable Effectiveness of Quasirandom Sequences. 2018 (powers of the generalised golden
// ratio)
#include <grapeshot/adb/tuning.hpp>

#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include <grapeshot/adb/detail/pair_walk.hpp>
#include <grapeshot/adb/detail/pose_range.hpp>
#include <grapeshot/adb/detail/require_setting.hpp>

namespace grapeshot {
namespace {

constexpr std::uint64_t watchedSteps[] = {1, 2, 4, 8};  // one for each of Tree::stepRates
constexpr std::uint64_t mostUnits = 4'000;              // of an exact answer
constexpr float mostOctaves = 4;
constexpr int halvings = 9;  // to a sixty-fourth of an octave
/// So many poses seen to be right as they are; or a few poses of a mesh that is hardly ever in doubt would move it far.
constexpr double prior = 1;

/// So many of them are as good as several times as many drawn ones.
std::vector<Pose> evenPoses(const Tree& tree, int count) {
    constexpr double ratio = 1.1127756842787055;  // x^7 = x + 1
    const detail::PoseRange range(tree, tree);
    std::vector<Pose> poses;
    for (int i = 1; i <= count; ++i) {
        std::array<double, 6> unit{};
        double stride = i;
        for (double& part : unit) {
            stride /= ratio;
            part = 0.5 + stride - std::floor(0.5 + stride);
        }
        poses.push_back(range.at(unit));
    }
    return poses;
}

/// After one number of steps: sums of rates, and what came of them.
using Seen = std::vector<std::pair<float, bool>>;
std::array<Seen, std::size(watchedSteps)> watch(const Tree& tree, int poses, const RateFormula& formula) {
    std::array<Seen, std::size(watchedSteps)> seen;
    detail::PairWalk walk(tree, tree);
    for (const Pose& pose : evenPoses(tree, poses)) {
        if (!walk.start(pose)) {
            continue;
        }
        const std::optional<bool> collides = walk.overlaps(detail::sidePair(0, 0), mostUnits);
        if (!collides) {
            continue;
        }
        std::uint64_t taken = 0;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            detail::EstimateEnd end = detail::EstimateEnd::budget;
            for (; taken < watchedSteps[i] && end == detail::EstimateEnd::budget; ++taken) {
                end = walk.estimate(formula);
            }
            if (end != detail::EstimateEnd::budget || !(walk.cut().rate > 0)) {
                break;  // certain
            }
            seen[i].emplace_back(walk.cut().rate, *collides);
        }
    }
    return seen;
}

/// By how many octaves the rates have to rise for the probabilities after so many steps to come true in sum. Their
/// excess over the truth is the derivative of the log-likelihood by the octaves, up to a factor, as far as the table is
/// a logistic curve; and it rises with the octaves.
float octavesFor(const Seen& seen, const Calibration& calibration, std::uint64_t steps) {
    float low = -mostOctaves;
    float high = mostOctaves;
    for (int i = 0; i < halvings; ++i) {
        const float octaves = 0.5F * (low + high);
        const float factor = std::exp2(octaves);
        double excess = prior * octaves;
        for (const auto& [rate, collides] : seen) {
            excess += probabilityAfter(calibration, factor * rate, steps) - (collides ? 1.0 : 0.0);
        }
        (excess > 0 ? high : low) = octaves;
    }
    return 0.5F * (low + high);
}

}  // namespace

void tune(Tree& tree, int poses, const Calibration& calibration) {
    detail::requireSetting(poses >= 0 && poses <= 10'000, "BuildSettings::tuningPoses", poses);
    tree.stepRates.fill(1);
    if (poses == 0 || tree.nodes.empty()) {
        return;
    }
    const auto seen = watch(tree, poses, calibration.formula);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        tree.stepRates[i] = seen[i].empty() ? 1 : std::exp2(octavesFor(seen[i], calibration, watchedSteps[i]));
    }
}

}  // namespace grapeshot
