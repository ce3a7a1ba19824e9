// Worlds stepped and watched, one or several in turns.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <scenes/world.hpp>

#include <report/report.hpp>

#include "scene_method.hpp"

namespace grapeshot::bench {

/// What a step cost our own engine, in work units; zero under any other.
struct StepWork {
    std::uint64_t work = 0;
    std::uint64_t mandatory = 0;
    int degraded = 0;
    std::uint32_t longestWait = 0;
    std::size_t pairs = 0;
    int tracked = 0;    ///< pairs that scf served
    int sampled = 0;    ///< of these, sampled
    int leftToAdb = 0;  ///< asked of scf, served by adb
};

/// What a run left behind: one record per step, and all poses of some steps.
struct Run {
    std::vector<scenes::StepRecord> steps;
    std::vector<StepWork> work;
    std::vector<scenes::Frame> frames;
    std::vector<double> narrowphaseUs;  ///< per step, processor time
    std::vector<double> stepUs;         ///< the same of the whole step
};

class Recorder {
  public:
    Recorder(scenes::World world, int frameEvery) : m_world(std::move(world)), m_frameEvery(frameEvery) {}
    void step();
    [[nodiscard]] scenes::World& world() { return m_world; }
    [[nodiscard]] const scenes::World& world() const { return m_world; }
    [[nodiscard]] Run& run() { return m_run; }
    [[nodiscard]] const Run& run() const { return m_run; }

  private:
    scenes::World m_world;
    int m_frameEvery;
    Run m_run;
};

/// To the last bit.
[[nodiscard]] bool samePoses(const scenes::Frame& x, const scenes::Frame& y);

/// Times of each step become the lesser of both runs; the worlds must have been the same. Returns whether all saved
/// poses are the same to the last bit.
bool mergeReplay(Run& run, const Run& replay);

/// How a scene is run.
struct Course {
    std::string scenario;
    double seconds = 10;
    double frameSeconds = 1.0 / 4;  ///< between saved poses
    double restSeconds = 1;         ///< at the end, in which nothing should move any more
    std::size_t coldSteps = 0;      ///< at the beginning, not counted in ratios: bodies touch, and no contact is known
    bool progress = true;           ///< a line per second on stderr
};

/// One method's run of a scene.
struct Outcome {
    SceneMethod method;
    Recorder recorder;
    double restSeconds = 1;                   ///< as in the course
    std::size_t coldSteps = 0;                ///< the same
    std::vector<double> firstNarrowphaseUs;   ///< per step, of the first, common run
    std::vector<double> narrowphaseTotalsUs;  ///< of every run
    int differing = 0;                        ///< replays of other poses
};

/// All methods in the same scene, step by step in turns, so that whatever else the machine does hits them alike. Then
/// replayed, as often as each method says.
[[nodiscard]] std::vector<Outcome> runInTurns(const Course& course, const std::vector<SceneMethod>& methods,
                                              const std::function<scenes::World(const scenes::WorldSettings&)>& make);

/// Steps until all fell asleep for good.
[[nodiscard]] std::size_t stepsAwake(const Run& run);

/// Time of one's step / time of the other's in the first, common run, both means while anybody is awake in it.
[[nodiscard]] double narrowphaseRatio(const Outcome& of, const Outcome& to);

/// Mean of the steps' least times while anybody is awake, us.
[[nodiscard]] double awakeMeanUs(const Run& run, const std::vector<double>& timesUs);

}  // namespace grapeshot::bench
