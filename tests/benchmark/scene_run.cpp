#include "scene_run.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace grapeshot::bench {

using scenes::Frame;
using scenes::StepRecord;

void Recorder::step() {
    m_run.steps.push_back(m_world.step());
    m_run.narrowphaseUs.push_back(m_run.steps.back().narrowphaseCpuSeconds * 1e6);
    if (m_run.steps.size() % static_cast<std::size_t>(m_frameEvery) == 0) {
        m_run.frames.push_back(m_world.poses());
    }
}

bool mergeReplay(Run& run, const Run& replay) {
    for (std::size_t i = 0; i < run.narrowphaseUs.size(); ++i) {
        run.narrowphaseUs[i] = std::min(run.narrowphaseUs[i], replay.narrowphaseUs[i]);
    }
    const auto samePose = [](const scenes::PoseD& x, const scenes::PoseD& y) {
        return x.rotation == y.rotation && x.translation == y.translation;
    };
    return std::ranges::equal(run.frames, replay.frames,
                              [&](const Frame& x, const Frame& y) { return std::ranges::equal(x, y, samePose); });
}

Depths depthsOf(const scenes::World& world, const std::vector<Frame>& frames) {
    Depths depths;
    for (const Frame& frame : frames) {
        double deepest = 0;
        for (const scenes::PairDepth& pair : world.penetrations(frame)) {
            depths.pairs.push_back(pair.depth);
            deepest = std::max(deepest, pair.depth);
        }
        depths.deepest.push_back(deepest);
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

report::Row summary(const std::string& scenario, const std::string& mesh, const scenes::World& world, const Run& run) {
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh;
    std::size_t triangles = 0;
    std::size_t moving = 0;
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        if (world.moving(body)) {
            triangles += world.mesh(body).triangles.size();
            ++moving;
        }
    }
    row.triangles = triangles / std::max<std::size_t>(1, moving);
    row.method = name(world.settings().engine);
    row.n = run.steps.size();
    row.timeUs = report::quantiles(run.narrowphaseUs);
    const auto mean = [&](auto member) {
        return std::accumulate(run.steps.begin(), run.steps.end(), 0.0,
                               [&](double sum, const StepRecord& step) { return sum + step.*member; }) /
               static_cast<double>(run.steps.size());
    };
    row.work = {{"contacts", mean(&StepRecord::contacts)}, {"manifolds", mean(&StepRecord::manifolds)}};
    const StepRecord& last = run.steps.back();
    row.measured = {{"lost", static_cast<double>(last.lost)}, {"energyEnd", last.kineticEnergy + last.potentialEnergy}};
    return row;
}

}  // namespace grapeshot::bench
