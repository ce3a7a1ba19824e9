#include <grapeshot/adb/certificate.hpp>

#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include <grapeshot/adb/certification_poses.hpp>
#include <grapeshot/adb/detail/fixed_sequence.hpp>
#include <grapeshot/adb/detail/require_setting.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/rate_bound.hpp>

namespace grapeshot {

using detail::requireSetting;

namespace {

/// The levels of both paths: the probability of being wrong at which an estimate is taken for an answer, from 0.0005 in
/// steps of a quarter to 0.5, where the likelier answer after the first step is taken. Fixed: no data touches them.
constexpr std::size_t levelCount = 32;
constexpr std::array<float, levelCount> levels = [] {
    std::array<float, levelCount> values{};
    double value = 0.5;
    for (std::size_t i = levelCount; i-- > 0; value /= 1.25) {
        values[i] = static_cast<float>(value);
    }
    return values;
}();

void check(const CertificationSettings& settings) {
    const auto isRate = [](double rate) { return rate > 0 && rate < 1; };
    requireSetting(isRate(settings.missLimit), "CertificationSettings::missLimit", settings.missLimit);
    requireSetting(isRate(settings.falseAlarmLimit), "CertificationSettings::falseAlarmLimit",
                   settings.falseAlarmLimit);
    requireSetting(settings.confidence >= 0.5 && settings.confidence < 1, "CertificationSettings::confidence",
                   settings.confidence);
    requireSetting(settings.poses >= 1 && settings.poses <= 10'000'000, "CertificationSettings::poses",
                   static_cast<double>(settings.poses));
    requireSetting(settings.estimateSteps >= 1, "CertificationSettings::estimateSteps",
                   static_cast<double>(settings.estimateSteps));
}

/// One pair of trees, its poses sorted by their truth, and what has been spent.
struct Bench {
    Query query;
    std::vector<Pose> colliding, clear;
    std::uint64_t work = 0;

    Decision decide(Query& asked, const Pose& pose, DecideSettings settings) {
        // A witness would tie the answers to the poses before, which must be independent. With it, errors only vanish.
        settings.tryWitness = false;
        const Decision decision = asked.decide(pose, settings);
        work += decision.work;
        return decision;
    }
    bool errs(Query& asked, bool truth, const Pose& pose, const DecideSettings& settings) {
        return decide(asked, pose, settings).collides != truth;
    }
};

/// How many poses of this truth are answered wrongly at each level of its path: with one side of the settings left to
/// the estimate, the other proven. A pose that errs at one level errs at all later ones (the limit is crossed no
/// later), so each is asked at the last level, and only if it errs there, by halves, where that begins.
std::array<std::uint64_t, levelCount> errorsByLevel(Bench& bench, bool truth, const DecideSettings& base) {
    // A query for each level: to change the settings of one costs more than to ask it.
    std::vector<Query> queries(levelCount, bench.query);
    const auto errsAt = [&](std::size_t level, const Pose& pose) {
        DecideSettings settings = base;
        settings.acceptAt = truth ? 1 : 1 - levels[level];
        settings.rejectAt = truth ? levels[level] : 0;
        return bench.errs(queries[level], truth, pose, settings);
    };
    std::array<std::uint64_t, levelCount> errors{};
    for (const Pose& pose : truth ? bench.colliding : bench.clear) {
        if (!errsAt(levelCount - 1, pose)) {
            continue;
        }
        std::size_t right = 0;  // levels known to be answered rightly, from the front
        std::size_t first = levelCount - 1;
        while (right < first) {
            const std::size_t middle = right + (first - right) / 2;
            if (errsAt(middle, pose)) {
                first = middle;
            } else {
                right = middle + 1;
            }
        }
        ++errors[first];
    }
    std::partial_sum(errors.begin(), errors.end(), errors.begin());
    return errors;
}

void sortByTruth(Bench& bench, std::span<const Pose> poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Decision truth = bench.decide(bench.query, poses[i], DecideSettings::exact());
        if (truth.stop == StopReason::invalidInput) {
            throw Error(Fault::notRigid, "not finite or no rotation", "pose " + std::to_string(i));
        }
        (truth.collides ? bench.colliding : bench.clear).push_back(poses[i]);
    }
}

std::string tooFew(const char* kind, std::size_t count, std::size_t all, double limit, double confidence) {
    return std::to_string(count) + " of " + std::to_string(all) + " poses are " + kind + ", at least " +
           std::to_string(fewestTrials(limit, confidence)) + " are needed";
}

Certificate refused(Certificate certificate, Refusal refusal, std::string reason) {
    certificate.refusal = refusal;
    certificate.reason = std::move(reason);
    certificate.workPerPose = certificate.exactWorkPerPose;
    return certificate;
}

}  // namespace

Certificate calibrate(const Tree& a, const Tree& b, const CertificationSettings& settings) {
    check(settings);
    Certificate certificate;
    certificate.missLimit = settings.missLimit;
    certificate.falseAlarmLimit = settings.falseAlarmLimit;
    certificate.confidence = settings.confidence;
    certificate.seed = settings.seed;

    std::vector<Pose> drawn;
    std::span<const Pose> poses = settings.givenPoses;
    certificate.poses = settings.givenName;
    if (poses.empty()) {
        drawn = certificationPoses(a, b, settings.poses, settings.seed);
        poses = drawn;
        certificate.poses = "zachmann";
    }
    Bench bench{Query(a, b), {}, {}};
    sortByTruth(bench, poses);
    const auto count = static_cast<double>(poses.size());
    certificate.colliding = bench.colliding.size();
    certificate.clear = bench.clear.size();
    certificate.exactWorkPerPose = static_cast<double>(bench.work) / count;
    certificate.work = bench.work;

    // Two paths, each with half of what may go wrong.
    const double confidence = 1 - 0.5 * (1 - settings.confidence);
    const std::int64_t mostMisses = detail::mostErrorsAllowed(certificate.colliding, settings.missLimit, confidence);
    const std::int64_t mostAlarms = detail::mostErrorsAllowed(certificate.clear, settings.falseAlarmLimit, confidence);
    if (mostMisses < 0) {
        return refused(certificate, Refusal::fewColliding,
                       tooFew("colliding", certificate.colliding, poses.size(), settings.missLimit, confidence));
    }
    if (mostAlarms < 0) {
        return refused(certificate, Refusal::fewClear,
                       tooFew("clear", certificate.clear, poses.size(), settings.falseAlarmLimit, confidence));
    }

    DecideSettings chosen;
    chosen.estimateSteps = settings.estimateSteps;
    chosen.acceptAt = 1;
    chosen.rejectAt = 0;
    chosen.adaptive = false;  // what is promised of the estimates is tried on them
    const detail::PathEnd no = detail::walkPath(errorsByLevel(bench, true, chosen), mostMisses);
    const detail::PathEnd yes = detail::walkPath(errorsByLevel(bench, false, chosen), mostAlarms);
    certificate.work = bench.work;
    if (no.passed == 0 && yes.passed == 0) {
        return refused(certificate, Refusal::tooManyErrors,
                       "more than " + std::to_string(mostMisses) + " misses and more than " +
                           std::to_string(mostAlarms) + " false alarms at the safest settings");
    }
    if (no.passed > 0) {
        chosen.rejectAt = levels[no.passed - 1];
    }
    if (yes.passed > 0) {
        chosen.acceptAt = 1 - levels[yes.passed - 1];
    }

    const std::uint64_t before = bench.work;
    for (const Pose& pose : bench.colliding) {
        certificate.misses += bench.errs(bench.query, true, pose, chosen) ? 1U : 0U;
    }
    for (const Pose& pose : bench.clear) {
        certificate.falseAlarms += bench.errs(bench.query, false, pose, chosen) ? 1U : 0U;
    }
    certificate.workPerPose = static_cast<double>(bench.work - before) / count;
    certificate.work = bench.work;
    certificate.missBound = no.passed > 0 ? upperRate(no.errors, certificate.colliding, confidence) : 0;
    certificate.falseAlarmBound = yes.passed > 0 ? upperRate(yes.errors, certificate.clear, confidence) : 0;
    certificate.settings = chosen;
    certificate.certified = true;
    return certificate;
}

}  // namespace grapeshot
