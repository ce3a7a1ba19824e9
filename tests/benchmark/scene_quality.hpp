// How good a motion was: judged by saved poses and by sums over the bodies, never by what a method says of itself.
#pragma once

#include <cstdint>
#include <vector>

#include <report/report.hpp>

#include "scene_run.hpp"

namespace grapeshot::bench {

/// True penetration in all saved frames, m.
struct Depths {
    std::vector<double> pairs;   ///< of every pair whose balls meet, in every frame
    std::vector<double> bodies;  ///< the deepest of each moving body's, in every frame
};
[[nodiscard]] Depths depthsOf(const scenes::World& world, const std::vector<scenes::Frame>& frames);

/// RMS over the last `seconds` of the run, m/s (see StepRecord::rmsSpeed).
[[nodiscard]] double residualSpeed(const Run& run, double seconds, double timeStep);

/// Kinetic and potential energy together, J.
struct EnergyCourse {
    double initial = 0;
    double mostOverInitial = 0;  ///< highest above the initial
    double mostRise = 0;         ///< highest above the least until then
};
[[nodiscard]] EnergyCourse energyCourse(const Run& run);

/// From the start until the last body fell asleep for good, s; not applicable if one is awake at the end. Lost bodies
/// do not count.
[[nodiscard]] double secondsToSleep(const Run& run, double timeStep);

/// Work units of a step until all sleep, mean.
[[nodiscard]] double meanWorkAwake(const Outcome& outcome);

/// Work units of a step, mean of the steps of `seconds` from `from` on, as far as the run goes; 0 if there are none.
[[nodiscard]] double meanWork(const Run& run, double timeStep, double from, double seconds);
/// The largest of these of windows of `seconds`, one after the other.
[[nodiscard]] double mostWork(const Run& run, double timeStep, double seconds);

/// What is judged of an outcome, or of several starts of a scene together.
struct Quality {
    int lost = 0;        ///< of all starts
    int awakeAtEnd = 0;  ///< the same
    /// Shares of the moving bodies' mean radius.
    report::Quantiles pairDepth, bodyDepth;
    std::size_t pairsJudged = 0;
    double energyRisePercent = 0;  ///< of the initial energy; of the worst start
    double energyOverInitialPercent = 0;
    double secondsToSleep = report::notApplicable;  ///< mean of the starts; not applicable if one stays awake
    double residualSpeed = 0;                       ///< RMS at the end, m/s; of the worst start
    double workMean = 0;                            ///< work units of a step until all sleep
    double degradedMean = 0;                        ///< pairs of such a step cut short
    double workBeyondBudget = 0;                    ///< most of a step beyond max(budget, mandatory slices)
    std::uint32_t longestWait = 0;                  ///< steps
};
[[nodiscard]] Quality judge(const Outcome& outcome);
[[nodiscard]] Quality judge(const std::vector<const Outcome*>& starts);

/// Mean radius of the moving bodies, m.
[[nodiscard]] double meanRadius(const scenes::World& world);

}  // namespace grapeshot::bench
