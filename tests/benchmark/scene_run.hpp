// One world, stepped and watched.
#pragma once

#include <vector>

#include <scenes/world.hpp>

#include <report/report.hpp>

namespace grapeshot::bench {

/// What a run left behind: one record per step, and all poses of every `frameEvery`-th step.
struct Run {
    std::vector<scenes::StepRecord> steps;
    std::vector<scenes::Frame> frames;
    std::vector<double> narrowphaseUs;  ///< per step, processor time
};

class Recorder {
  public:
    Recorder(scenes::World world, int frameEvery) : m_world(std::move(world)), m_frameEvery(frameEvery) {}
    void step();
    [[nodiscard]] scenes::World& world() { return m_world; }
    [[nodiscard]] const Run& run() const { return m_run; }

  private:
    scenes::World m_world;
    int m_frameEvery;
    Run m_run;
};

/// Time of each step becomes the lesser of both runs; the worlds must have been the same. Returns whether all saved
/// poses are the same to the last bit.
bool mergeReplay(Run& run, const Run& replay);

/// True penetration in all saved frames, m.
struct Depths {
    std::vector<double> pairs;    ///< of every pair whose boxes meet, in every frame
    std::vector<double> deepest;  ///< of each frame
};
[[nodiscard]] Depths depthsOf(const scenes::World& world, const std::vector<scenes::Frame>& frames);

/// RMS over the last `seconds` of the run, m/s (see StepRecord::rmsSpeed).
[[nodiscard]] double residualSpeed(const Run& run, double seconds, double timeStep);

/// The row that every scene has: times, contacts, manifolds, bodies lost, energy.
[[nodiscard]] report::Row summary(const std::string& scenario, const std::string& mesh, const scenes::World& world,
                                  const Run& run);

}  // namespace grapeshot::bench
