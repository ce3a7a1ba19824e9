#include <algorithm>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <report/machine.hpp>

#include "scene_rows.hpp"
#include "soft_demo_scenes.hpp"
#include "soft_run.hpp"
#include "soft_scenarios.hpp"

namespace grapeshot::bench {

namespace {

constexpr int sampleEvery = 10;  // steps
/// Of processor time, both worlds of a scene together: what takes longer is stopped, both after the same step.
constexpr double limitSeconds = 15;

class DemoCourse {
  public:
    DemoCourse(const SoftDemo& demo, scenes::Engine engine) : m_world(engine, demo.deformable) { demo.build(m_world); }

    void step() {
        if (m_finite) {
            const double start = report::threadCpuUs();
            m_world.step();
            m_stepsUs.push_back(report::threadCpuUs() - start);
            m_takenUs += m_stepsUs.back();
        }
    }
    void sample() {
        m_finite = m_finite && m_world.isFinite();
        m_insideEnd = m_finite ? m_world.nodesInside() : 0;
        m_insideSum += m_insideEnd;
        ++m_samples;
    }
    [[nodiscard]] bool isFinite() const { return m_finite; }
    [[nodiscard]] double takenSeconds() const { return m_takenUs / 1e6; }
    /// Nodes, of the samples.
    [[nodiscard]] double insideMean() const { return m_insideSum / std::max(1, m_samples); }
    [[nodiscard]] int nodes() const { return m_world.nodes(); }

    [[nodiscard]] report::Row row(const SoftDemo& demo, const std::string& method) const {
        report::Row row;
        row.scenario = "demo " + std::string(demo.name);
        row.mesh = demo.deformable ? "deformable world" : "soft-rigid world";
        row.method = method;
        row.n = m_stepsUs.size();
        row.timeUs = report::quantiles(m_stepsUs);
        row.measured = {{"finite", m_finite ? 1.0 : 0.0},
                        {"seconds", static_cast<double>(m_stepsUs.size()) / 60},
                        {"insideMean", insideMean()},
                        {"insideEnd", static_cast<double>(m_insideEnd)},
                        {"nodes", static_cast<double>(nodes())}};
        return row;
    }

  private:
    SoftDemoWorld m_world;
    std::vector<double> m_stepsUs;
    double m_takenUs = 0;
    bool m_finite = true;
    double m_insideSum = 0;
    int m_insideEnd = 0;
    int m_samples = 0;
};

void runCourses(std::span<const std::unique_ptr<DemoCourse>> courses, int steps) {
    bool late = false;
    for (int step = 1; step <= steps && !late; ++step) {
        double taken = 0;
        for (const auto& course : courses) {
            course->step();
            taken += course->takenSeconds();
        }
        late = taken > limitSeconds;
        if (step % sampleEvery == 0 || late) {
            for (const auto& course : courses) {
                course->sample();
            }
        }
    }
}

}  // namespace

void runSoftDemos(const Options& options, report::Report& results) {
    const int steps = options.quick ? sampleEvery : 240;
    for (const SoftDemo& demo : softDemos()) {
        const std::string name(demo.name);
        std::vector<std::unique_ptr<DemoCourse>> courses;
        courses.push_back(std::make_unique<DemoCourse>(demo, scenes::Engine::grapeshot));
        if (!options.quick) {
            courses.push_back(std::make_unique<DemoCourse>(demo, scenes::Engine::none));
        }
        runCourses(courses, steps);
        const DemoCourse& ours = *courses.front();
        const DemoCourse& theirs = *courses.back();
        results.rows.push_back(ours.row(demo, "grapeshot"));
        Claims claims("soft demo " + name, results);
        claims.atLeast("nodes are where numbers say, or not with Bullet's own either",
                       ours.isFinite() || (!theirs.isFinite() && courses.size() > 1) ? 1 : 0, 1);
        if (courses.size() > 1) {
            results.rows.push_back(theirs.row(demo, bulletsOwn));
            // Where both are the same but for rounding, bodies fall in other ways: a node or two is chance.
            claims.atMost("nodes inside of rigid bodies, mean of the course", ours.insideMean(),
                          theirs.insideMean() + 0.002 * theirs.nodes());
        }
        std::cerr << "demo " << name << ": " << ours.insideMean() << " of " << ours.nodes()
                  << " nodes inside, Bullet's own " << theirs.insideMean() << '\n';
    }
}

}  // namespace grapeshot::bench
