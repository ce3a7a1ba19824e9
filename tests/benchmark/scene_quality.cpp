#include "scene_quality.hpp"

#include <algorithm>
#include <cmath>

namespace grapeshot::bench {

using scenes::Frame;
using scenes::StepRecord;
using scenes::World;

namespace {

/// Penetration in one frame.
Depths depthsOf(const World& world, const Frame& frame) {
    Depths depths;
    std::vector<double> ofBody(world.bodies(), 0);
    for (const scenes::PairDepth& pair : world.penetrations(frame)) {
        depths.pairs.push_back(pair.depth);
        ofBody[pair.a] = std::max(ofBody[pair.a], pair.depth);
        ofBody[pair.b] = std::max(ofBody[pair.b], pair.depth);
    }
    for (std::size_t body = 0; body < ofBody.size(); ++body) {
        if (world.moving(body)) {
            depths.bodies.push_back(ofBody[body]);
        }
    }
    return depths;
}

void append(const std::vector<double>& lengths, double unit, std::vector<double>& shares) {
    for (const double length : lengths) {
        shares.push_back(length / unit);
    }
}

}  // namespace

Depths depthsOf(const World& world, const std::vector<Frame>& frames) {
    Depths depths;
    Depths last;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (i == 0 || !samePoses(frames[i], frames[i - 1])) {  // else all are asleep
            last = depthsOf(world, frames[i]);
        }
        append(last.pairs, 1, depths.pairs);
        append(last.bodies, 1, depths.bodies);
    }
    return depths;
}

double residualSpeed(const Run& run, double seconds, double timeStep) {
    const auto count = std::min(run.steps.size(), static_cast<std::size_t>(std::lround(seconds / timeStep)));
    double squares = 0;
    for (std::size_t i = run.steps.size() - count; i < run.steps.size(); ++i) {
        squares += run.steps[i].rmsSpeed * run.steps[i].rmsSpeed;
    }
    return std::sqrt(squares / static_cast<double>(count));
}

EnergyCourse energyCourse(const Run& run) {
    EnergyCourse course;
    const auto energy = [](const StepRecord& step) { return step.kineticEnergy + step.potentialEnergy; };
    course.initial = energy(run.steps.front());
    double least = course.initial;
    for (const StepRecord& step : run.steps) {
        least = std::min(least, energy(step));
        course.mostRise = std::max(course.mostRise, energy(step) - least);
        course.mostOverInitial = std::max(course.mostOverInitial, energy(step) - course.initial);
    }
    return course;
}

double secondsToSleep(const Run& run, double timeStep) {
    return run.steps.back().awake > 0 ? report::notApplicable : static_cast<double>(stepsAwake(run)) * timeStep;
}

double meanWorkAwake(const Outcome& outcome) {
    const Run& run = outcome.recorder.run();
    const std::size_t steps = std::max<std::size_t>(1, stepsAwake(run));
    double work = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        work += static_cast<double>(run.work[i].work);
    }
    return work / static_cast<double>(steps);
}

double meanWork(const Run& run, double timeStep, double from, double seconds) {
    const auto stepAt = [&](double time) {
        return std::min(run.work.size(), static_cast<std::size_t>(std::lround(time / timeStep)));
    };
    const std::size_t first = stepAt(from);
    const std::size_t last = stepAt(from + seconds);
    double work = 0;
    for (std::size_t i = first; i < last; ++i) {
        work += static_cast<double>(run.work[i].work);
    }
    return first < last ? work / static_cast<double>(last - first) : 0.0;
}

double mostWork(const Run& run, double timeStep, double seconds) {
    const double end = static_cast<double>(run.work.size()) * timeStep;
    double most = 0;
    for (int window = 0; window * seconds < end; ++window) {
        most = std::max(most, meanWork(run, timeStep, window * seconds, seconds));
    }
    return most;
}

double meanRadius(const World& world) {
    double radii = 0;
    int moving = 0;
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        if (world.moving(body)) {
            radii += world.radius(body);
            ++moving;
        }
    }
    return radii / std::max(1, moving);
}

namespace {

void addWork(const Outcome& outcome, double share, Quality& quality) {
    const Run& run = outcome.recorder.run();
    const std::uint64_t budget = outcome.method.world.settings.frameBudget.work;
    const std::size_t steps = std::max<std::size_t>(1, stepsAwake(run));
    quality.workMean += share * meanWorkAwake(outcome);
    for (std::size_t i = 0; i < run.work.size(); ++i) {
        const StepWork& step = run.work[i];
        quality.degradedMean += i < steps ? share * step.degraded / static_cast<double>(steps) : 0.0;
        quality.longestWait = std::max(quality.longestWait, step.longestWait);
        const std::uint64_t most = std::max(budget, step.mandatory);
        if (step.work > most) {
            quality.workBeyondBudget = std::max(quality.workBeyondBudget, static_cast<double>(step.work - most));
        }
    }
}

}  // namespace

Quality judge(const std::vector<const Outcome*>& starts) {
    Quality quality;
    Depths shares;
    const double share = 1.0 / static_cast<double>(starts.size());
    double sleeping = 0;
    for (const Outcome* outcome : starts) {
        const World& world = outcome->recorder.world();
        const Run& run = outcome->recorder.run();
        const double timeStep = world.settings().timeStep;
        quality.lost += run.steps.back().lost;
        quality.awakeAtEnd += run.steps.back().awake;
        const Depths depths = depthsOf(world, run.frames);
        const double radius = meanRadius(world);
        append(depths.pairs, radius, shares.pairs);
        append(depths.bodies, radius, shares.bodies);
        const EnergyCourse energy = energyCourse(run);
        const double initial = std::abs(energy.initial);
        quality.energyRisePercent = std::max(quality.energyRisePercent, 100 * energy.mostRise / initial);
        quality.energyOverInitialPercent =
            std::max(quality.energyOverInitialPercent, 100 * energy.mostOverInitial / initial);
        sleeping += share * secondsToSleep(run, timeStep);
        quality.residualSpeed = std::max(quality.residualSpeed, residualSpeed(run, outcome->restSeconds, timeStep));
        addWork(*outcome, share, quality);
    }
    quality.secondsToSleep = sleeping;
    quality.pairsJudged = shares.pairs.size();
    quality.pairDepth = report::quantiles(std::move(shares.pairs));
    quality.bodyDepth = report::quantiles(std::move(shares.bodies));
    return quality;
}

Quality judge(const Outcome& outcome) {
    return judge({&outcome});
}

}  // namespace grapeshot::bench
