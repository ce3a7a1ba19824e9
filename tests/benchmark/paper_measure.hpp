// One model, one set of parameters: errors against the exact answers, and time against the exact traversals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <grapeshot/adb/reference/adb_query.hpp>
#include <grapeshot/adb/reference/exact_query.hpp>
#include <report/machine.hpp>
#include <report/report.hpp>

#include "paper_models.hpp"

namespace grapeshot::bench {

/// Exact answers to all poses of a model.
struct PaperTruth {
    std::vector<std::vector<char>> collides;  ///< per distance, per pose
    std::size_t poses = 0;
    std::size_t betweenExact = 0;  ///< poses on which boxes and DOPs disagree
    std::size_t withLibrary = 0;   ///< poses on which Query::decide disagrees, beyond rounding to single precision
    double boxTests = 0;           ///< volume tests per query
    double dopTests = 0;
};
[[nodiscard]] PaperTruth truthOf(const PaperModel& model, const Turns& turns);

/// Of the queries whose outermost volumes intersect.
struct PaperErrors {
    std::size_t n = 0;
    std::size_t colliding = 0;
    std::size_t falseNegatives = 0;
    std::size_t falsePositives = 0;
    std::size_t gaveUp = 0;
    double pairs = 0;  ///< taken from the queue, all queries
    double volumeTests = 0;
    double estimates = 0;
    double triangleTests = 0;

    /// "Percentage of wrong detections"; 0 if there is no such query.
    [[nodiscard]] double percent() const {
        const auto wrong = static_cast<double>(falseNegatives + falsePositives);
        return n == 0 ? 0 : 100 * wrong / static_cast<double>(n);
    }
    PaperErrors& operator+=(const PaperErrors& other);
};

/// Counts per distance.
template <class V>
[[nodiscard]] std::vector<PaperErrors> errorsOf(reference::AdbQuery<V>& query, const Turns& turns,
                                                const PaperTruth& truth) {
    std::vector<PaperErrors> result;
    for (std::size_t d = 0; d < turns.poses.size(); ++d) {
        PaperErrors& errors = result.emplace_back();
        for (std::size_t i = 0; i < turns.poses[d].size(); ++i) {
            const reference::Answer answer = query.decide(turns.poses[d][i]);
            const bool collides = truth.collides[d][i] != 0;
            errors.pairs += static_cast<double>(answer.pairs);
            errors.volumeTests += static_cast<double>(answer.volumeTests);
            errors.estimates += static_cast<double>(answer.estimates);
            errors.triangleTests += static_cast<double>(answer.triangleTests);
            if (answer.ending == reference::Ending::rootsDisjoint) {
                continue;
            }
            ++errors.n;
            errors.colliding += collides ? 1U : 0U;
            errors.falseNegatives += collides && !answer.collides ? 1U : 0U;
            errors.falsePositives += !collides && answer.collides ? 1U : 0U;
            errors.gaveUp += answer.ending == reference::Ending::gaveUp ? 1U : 0U;
        }
    }
    return result;
}

/// Mean over the distances within [low, high], %: how the paper averages its curves.
[[nodiscard]] double meanPercent(const std::vector<PaperErrors>& errors, const Turns& turns, double low, double high);
[[nodiscard]] PaperErrors total(const std::vector<PaperErrors>& errors);

/// Mean time per query, us, of one turn.
template <class Query>
double timeTurn(Query& query, const std::vector<Pose>& poses) {
    std::size_t collisions = 0;
    const double start = report::threadCpuUs();
    for (const Pose& pose : poses) {
        collisions += query.decide(pose).collides ? 1U : 0U;
    }
    const double time = report::threadCpuUs() - start;
    volatile std::size_t sink = collisions;  // or the compiler may leave the questions out
    static_cast<void>(sink);
    return time / static_cast<double>(poses.size());
}

/// Per distance, us: medians of the repetitions; the ratios are medians of the repetitions' ratios.
struct PaperTimes {
    std::vector<double> adb, dop, box;
    std::vector<double> dopRatio, boxRatio;  ///< exact / ADB
};

/// All three on the same turn, one right after the other and taking turns in going first.
template <class V>
[[nodiscard]] PaperTimes timesOf(reference::AdbQuery<V>& adb, const PaperModel& model, const Turns& turns,
                                 int repetitions) {
    reference::ExactQuery<PaperDop> dop(model.dops, model.dops);
    reference::ExactQuery<reference::Box> box(model.boxes, model.boxes);
    PaperTimes times;
    for (const std::vector<Pose>& poses : turns.poses) {
        std::vector<double> each[3];
        std::vector<double> ratios[2];
        for (int repetition = 0; repetition < repetitions; ++repetition) {
            double us[3] = {};
            for (int k = 0; k < 3; ++k) {
                const int which = (k + repetition) % 3;
                us[which] = which == 0   ? timeTurn(adb, poses)
                            : which == 1 ? timeTurn(dop, poses)
                                         : timeTurn(box, poses);
            }
            for (int which = 0; which < 3; ++which) {
                each[which].push_back(us[which]);
            }
            ratios[0].push_back(us[1] / us[0]);
            ratios[1].push_back(us[2] / us[0]);
        }
        times.adb.push_back(report::median(each[0]));
        times.dop.push_back(report::median(each[1]));
        times.box.push_back(report::median(each[2]));
        times.dopRatio.push_back(report::median(ratios[0]));
        times.boxRatio.push_back(report::median(ratios[1]));
    }
    return times;
}

}  // namespace grapeshot::bench
