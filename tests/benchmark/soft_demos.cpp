#include <algorithm>
#include <iostream>
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

struct DemoCourse {
    bool finite = true;
    double insideMean = 0;  ///< nodes, of the samples
    int insideEnd = 0;
    int nodes = 0;
    std::vector<double> stepsUs;
};

DemoCourse runDemo(const SoftDemo& demo, scenes::Engine engine, int steps) {
    SoftDemoWorld world(engine, demo.deformable);
    demo.build(world);
    DemoCourse course;
    course.nodes = world.nodes();
    int samples = 0;
    for (int step = 1; step <= steps && course.finite; ++step) {
        const double start = report::threadCpuUs();
        world.step();
        course.stepsUs.push_back(report::threadCpuUs() - start);
        if (step % sampleEvery == 0) {
            course.finite = world.isFinite();
            course.insideEnd = course.finite ? world.nodesInside() : 0;
            course.insideMean += course.insideEnd;
            ++samples;
        }
    }
    course.insideMean /= std::max(1, samples);
    return course;
}

}  // namespace

void runSoftDemos(const Options& options, report::Report& results) {
    const int steps = options.quick ? sampleEvery : 240;
    for (const SoftDemo& demo : softDemos()) {
        const std::string name(demo.name);
        std::vector<DemoCourse> courses{runDemo(demo, scenes::Engine::grapeshot, steps)};
        if (!options.quick) {
            courses.push_back(runDemo(demo, scenes::Engine::none, steps));
        }
        for (std::size_t i = 0; i < courses.size(); ++i) {
            report::Row row;
            row.scenario = "demo " + name;
            row.mesh = demo.deformable ? "deformable world" : "soft-rigid world";
            row.method = i == 0 ? "grapeshot" : bulletsOwn;
            row.n = courses[i].stepsUs.size();
            row.timeUs = report::quantiles(courses[i].stepsUs);
            row.measured = {{"finite", courses[i].finite ? 1.0 : 0.0},
                            {"insideMean", courses[i].insideMean},
                            {"insideEnd", static_cast<double>(courses[i].insideEnd)},
                            {"nodes", static_cast<double>(courses[i].nodes)}};
            results.rows.push_back(std::move(row));
        }
        Claims claims("soft demo " + name, results);
        const bool isBulletFinite = courses.back().finite;
        claims.atLeast("nodes are where numbers say, or not with Bullet's own either",
                       courses[0].finite || (!isBulletFinite && courses.size() > 1) ? 1 : 0, 1);
        if (courses.size() > 1) {
            // Where both are the same but for rounding, bodies fall in other ways: a node or two is chance.
            claims.atMost("nodes inside of rigid bodies, mean of the course", courses[0].insideMean,
                          courses[1].insideMean + 0.002 * courses[1].nodes);
        }
        std::cerr << "demo " << name << ": " << courses.front().insideMean << " of " << courses.front().nodes
                  << " nodes inside, Bullet's own " << courses.back().insideMean << '\n';
    }
}

}  // namespace grapeshot::bench
