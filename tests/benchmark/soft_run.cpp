#include "soft_run.hpp"

#include <algorithm>
#include <iostream>

namespace grapeshot::bench {

std::vector<SoftMethod> softMethods() {
    return {{.name = "grapeshot"},
            {.name = bulletsOwn, .engine = scenes::Engine::none},
            {.name = "grapeshotBulletSolver", .ownSolver = false}};
}

std::vector<SoftOutcome> runSoft(const SoftCourse& course, const std::vector<SoftMethod>& methods,
                                 const SoftScene& scene) {
    std::vector<SoftOutcome> outcomes;
    for (const SoftMethod& method : methods) {
        outcomes.push_back({.method = method, .world = scene(method), .steps = {}});
    }
    std::vector<double> takenUs(outcomes.size(), 0);
    for (int step = 0; step < course.steps; ++step) {
        for (std::size_t turn = 0; turn < outcomes.size(); ++turn) {
            const std::size_t i = step % 2 == 0 ? turn : outcomes.size() - 1 - turn;
            SoftOutcome& outcome = outcomes[i];
            if (takenUs[i] > course.limitSeconds * 1e6) {
                continue;
            }
            outcome.steps.push_back(outcome.world->step());
            takenUs[i] += step > 0 ? outcome.steps.back().wholeUs : 0;  // in the first one Bullet builds its trees
            outcome.workMean += static_cast<double>(outcome.world->ours().work);
            outcome.degraded += outcome.world->ours().degraded;
            if (takenUs[i] > course.limitSeconds * 1e6) {
                std::cerr << course.scenario << ": " << outcome.method.name << " stopped after " << step + 1
                          << " steps\n";
            }
        }
        if ((step + 1) % 60 == 0) {
            std::cerr << course.scenario << ": " << (step + 1) / 60 << " s\n";
        }
    }
    for (SoftOutcome& outcome : outcomes) {
        outcome.workMean /= static_cast<double>(std::max<std::size_t>(1, outcome.steps.size()));
    }
    return outcomes;
}

double softRatio(const SoftOutcome& of, const SoftOutcome& to, double SoftStep::*part) {
    double ofUs = 0;
    double toUs = 0;
    for (std::size_t i = 1; i < std::min(of.steps.size(), to.steps.size()); ++i) {
        ofUs += of.steps[i].*part;
        toUs += to.steps[i].*part;
    }
    return toUs > 0 ? ofUs / toUs : report::notApplicable;
}

void addSoftRows(const SoftCourse& course, const std::vector<SoftOutcome>& outcomes, const SoftJudge& judge,
                 report::Report& results) {
    const auto peer = std::ranges::find(
        outcomes, bulletsOwn, [](const SoftOutcome& outcome) -> const std::string& { return outcome.method.name; });
    struct Part {
        const char* name;
        double SoftStep::*time;
    };
    constexpr Part parts[] = {{"step", &SoftStep::wholeUs}, {"collision", &SoftStep::collisionUs}};
    for (const SoftOutcome& outcome : outcomes) {
        double contacts = 0;
        for (const SoftStep& step : outcome.steps) {
            contacts += step.contacts;
        }
        const report::NamedNumbers judged = judge(*outcome.world);
        for (const Part& part : parts) {
            report::Row row;
            row.scenario = course.scenario + ", " + part.name;
            row.mesh = course.mesh;
            row.triangles = outcome.world->mesh(0).triangles.size();
            row.method = outcome.method.name;
            row.n = outcome.steps.size();
            std::vector<double> times;
            for (std::size_t i = 1; i < outcome.steps.size(); ++i) {
                times.push_back(outcome.steps[i].*part.time);
            }
            row.timeUs = report::quantiles(times);
            row.work = {{"contacts", contacts / static_cast<double>(std::max<std::size_t>(1, outcome.steps.size()))},
                        {"work", outcome.workMean},
                        {"degraded", static_cast<double>(outcome.degraded)}};
            row.measured = judged;
            if (!outcome.steps.empty()) {
                row.measured.emplace_back("firstStepUs", outcome.steps.front().*part.time);
            }
            if (peer != outcomes.end() && &*peer != &outcome) {
                row.peer = bulletsOwn;
                row.ratio = softRatio(*peer, outcome, part.time);
            }
            std::cerr << row.scenario << ", " << row.method << ": " << row.timeUs.mean / 1e3 << " ms, ratio "
                      << row.ratio << '\n';
            results.rows.push_back(std::move(row));
        }
    }
}

}  // namespace grapeshot::bench
