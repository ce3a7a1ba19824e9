#include "scene_run.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

namespace grapeshot::bench {

using scenes::Frame;

void Recorder::step() {
    m_run.steps.push_back(m_world.step());
    m_run.narrowphaseUs.push_back(m_run.steps.back().narrowphaseCpuSeconds * 1e6);
    m_run.stepUs.push_back(m_run.steps.back().cpuSeconds * 1e6);
    const StepStatistics& ours = statistics(&m_world.dispatcher());
    m_run.work.push_back({ours.work, ours.mandatory, ours.degraded, ours.longestWait, ours.pairs.size(), ours.tracked,
                          ours.sampled, ours.leftToAdb});
    if (m_run.steps.size() % static_cast<std::size_t>(m_frameEvery) == 0) {
        m_run.frames.push_back(m_world.poses());
    }
}

bool samePoses(const Frame& x, const Frame& y) {
    return std::ranges::equal(x, y, [](const scenes::PoseD& p, const scenes::PoseD& q) {
        return p.rotation == q.rotation && p.translation == q.translation;
    });
}

bool mergeReplay(Run& run, const Run& replay) {
    for (std::size_t i = 0; i < run.narrowphaseUs.size(); ++i) {
        run.narrowphaseUs[i] = std::min(run.narrowphaseUs[i], replay.narrowphaseUs[i]);
        run.stepUs[i] = std::min(run.stepUs[i], replay.stepUs[i]);
    }
    return std::ranges::equal(run.frames, replay.frames, samePoses);
}

namespace {

double sum(const std::vector<double>& values, std::size_t first) {
    return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first), 0.0);
}

double sum(const std::vector<double>& values) {
    return sum(values, values.size());
}

/// One run of all; each world keeps its own time step.
std::vector<Recorder> runOnce(const Course& course, const std::vector<const SceneMethod*>& methods,
                              const std::function<scenes::World(const scenes::WorldSettings&)>& make) {
    std::vector<Recorder> recorders;
    for (const SceneMethod* method : methods) {
        const double timeStep = method->world.timeStep;
        recorders.emplace_back(make(method->world),
                               std::max(1, static_cast<int>(std::lround(course.frameSeconds / timeStep))));
    }
    double said = 0;
    for (bool more = true; more;) {
        more = false;
        double slowest = course.seconds;
        for (const Recorder& recorder : recorders) {
            slowest = std::min(slowest,
                               static_cast<double>(recorder.run().steps.size()) * recorder.world().settings().timeStep);
        }
        for (Recorder& recorder : recorders) {
            const double timeStep = recorder.world().settings().timeStep;
            const double now = static_cast<double>(recorder.run().steps.size()) * timeStep;
            if (now < slowest + 0.5 * timeStep && now < course.seconds - 0.5 * timeStep) {
                recorder.step();
                more = true;
            }
        }
        if (course.progress && slowest >= said + 1) {
            said = std::floor(slowest);
            std::cerr << course.scenario << ": " << said << " s of " << course.seconds << '\n';
        }
    }
    return recorders;
}

}  // namespace

std::vector<Outcome> runInTurns(const Course& course, const std::vector<SceneMethod>& methods,
                                const std::function<scenes::World(const scenes::WorldSettings&)>& make) {
    std::vector<const SceneMethod*> all;
    int most = 1;
    for (const SceneMethod& method : methods) {
        all.push_back(&method);
        most = std::max(most, method.runs);
    }
    std::vector<Outcome> outcomes;
    std::vector<Recorder> first = runOnce(course, all, make);
    for (std::size_t i = 0; i < methods.size(); ++i) {
        const std::vector<double> times = first[i].run().narrowphaseUs;
        outcomes.push_back(
            {methods[i], std::move(first[i]), course.restSeconds, course.coldSteps, times, {sum(times)}, 0});
    }
    for (int run = 1; run < most; ++run) {
        std::vector<const SceneMethod*> again;
        std::vector<Outcome*> places;
        for (Outcome& outcome : outcomes) {
            if (outcome.method.runs > run) {
                again.push_back(&outcome.method);
                places.push_back(&outcome);
            }
        }
        Course quiet = course;
        quiet.progress = false;
        const std::vector<Recorder> replays = runOnce(quiet, again, make);
        for (std::size_t i = 0; i < replays.size(); ++i) {
            places[i]->narrowphaseTotalsUs.push_back(sum(replays[i].run().narrowphaseUs));
            places[i]->differing += mergeReplay(places[i]->recorder.run(), replays[i].run()) ? 0 : 1;
        }
    }
    return outcomes;
}

std::size_t stepsAwake(const Run& run) {
    std::size_t last = run.steps.size();
    while (last > 0 && run.steps[last - 1].awake == 0) {
        --last;
    }
    return last;
}

double narrowphaseRatio(const Outcome& of, const Outcome& to) {
    // Steps in which all sleep cost next to nothing, but may be many.
    const auto meanUs = [](const Outcome& outcome) {
        const std::size_t end = stepsAwake(outcome.recorder.run());
        const std::size_t begin = std::min(outcome.coldSteps, end);
        const double time = sum(outcome.firstNarrowphaseUs, end) - sum(outcome.firstNarrowphaseUs, begin);
        return time / static_cast<double>(std::max<std::size_t>(1, end - begin));
    };
    return meanUs(of) / meanUs(to);
}

double awakeMeanUs(const Run& run, const std::vector<double>& timesUs) {
    const std::size_t steps = std::max<std::size_t>(1, stepsAwake(run));
    return sum(timesUs, steps) / static_cast<double>(steps);
}

}  // namespace grapeshot::bench
