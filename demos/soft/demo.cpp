#include "demo.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>

#include <report/text_file.hpp>

#include "judged_run.hpp"

namespace grapeshot::soft {

namespace {

constexpr int picturesOfRun = 6;

std::vector<Method> methodsOf(const DemoOptions& options) {
    std::vector<Method> methods{Method::grapeshot};
    for (const Method method : {Method::exact, Method::bullet}) {
        if (options.against == name(method)) {
            methods.push_back(method);
        }
    }
    return methods;
}

void show(const JudgedRun& run, const DemoOptions& options, int number) {
    char title[128];
    std::snprintf(title, sizeof title, "%s, %s, %.2f s", run.scene.name.c_str(),
                  std::string(name(run.scene.world->method())).c_str(),
                  timeStep * static_cast<double>(run.records.size()));
    const std::string file =
        run.scene.name + "-" + std::string(name(run.scene.world->method())) + "-" + std::to_string(number) + ".png";
    picture(run, title).save(options.pictures / file);
}

/// Of a run that takes long, once per simulated second.
void say(const JudgedRun& run) {
    const StepRecord& now = run.records.back();
    std::fprintf(stderr, "%s %s %.0f s: step %.1f ms, detection %.1f ms", run.scene.name.c_str(),
                 std::string(name(run.scene.world->method())).c_str(),
                 timeStep * static_cast<double>(run.records.size()), 1e3 * now.seconds, 1e3 * now.detectionSeconds);
    if (now.exact) {
        std::fprintf(stderr, ", exact %.1f ms, %zu of %zu covered", 1e3 * now.exact->seconds, now.exact->covered,
                     now.exact->contacts);
    }
    std::fprintf(stderr, ", %.0f units, %d contacts, %d nodes held, %zu edges tangled, %zu pierced\n", now.work,
                 now.contacts, now.held, run.lastTangle, run.lastPierced);
}

void runScene(const SceneMaker& maker, const DemoOptions& options, report::Report& report) {
    std::vector<std::unique_ptr<JudgedRun>> runs;
    std::vector<const JudgedRun*> views;
    for (const Method method : methodsOf(options)) {
        runs.push_back(std::make_unique<JudgedRun>(maker(method)));
        views.push_back(runs.back().get());
    }
    // Step by step in turns, so that what else the machine does hits all alike.
    const int end = options.stop > 0 ? std::min(options.stop, options.steps) : options.steps;
    for (int step = 0; step < end; ++step) {
        for (const auto& run : runs) {
            const bool shown = !options.pictures.empty() &&
                               step * picturesOfRun / options.steps != (step - 1) * picturesOfRun / options.steps;
            if (step == 0 || shown) {
                run->judge();
            }
            if (!options.pictures.empty() && (step == 0 || shown)) {
                show(*run, options, step * picturesOfRun / options.steps);
            }
            run->advance(static_cast<std::size_t>(options.judged));
            if (options.progress && (step + 1) % 60 == 0) {
                say(*run);
            }
        }
    }
    for (const auto& run : runs) {
        run->judge();
        if (!options.pictures.empty()) {
            show(*run, options, picturesOfRun);
        }
    }
    if (!options.pictures.empty()) {
        frameTimes(views).save(options.pictures / (runs.front()->scene.name + "-times.png"));
        forceCurve(views).save(options.pictures / (runs.front()->scene.name + "-force.png"));
    }
    for (const auto& run : runs) {
        appendTo(report, *run, run == runs.front() && runs.size() > 1 ? runs.back().get() : nullptr);
    }
}

}  // namespace

void addOptions(CLI::App& app, DemoOptions& options) {
    app.add_option("--seed", options.seed, "of the samples")->capture_default_str();
    app.add_option("--steps", options.steps, "of 1/60 s")->check(CLI::Range(1, 1000000))->capture_default_str();
    app.add_option("--stop", options.stop, "end after so many of the steps; 0: after all")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    app.add_option("--judge", options.judged, "look for edges that pass through triangles in every such step")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_flag("--progress", options.progress, "a line per simulated second, to the standard error");
    app.add_option("--json", options.json, "write the numbers to this file");
    app.add_option("--pictures", options.pictures, "write pictures to this folder");
    app.add_option("--against", options.against,
                   "the same scene by another method, in turns: exact (ours without a budget), bullet")
        ->check(CLI::IsMember({"none", "exact", "bullet"}))
        ->capture_default_str();
}

int demo(const std::string& suite, const DemoOptions& options, const std::vector<SceneMaker>& makers) {
    if (!options.pictures.empty()) {
        std::filesystem::create_directories(options.pictures);
    }
    report::Report report{.suite = suite, .seed = options.seed, .quick = false, .rows = {}, .claims = {}};
    for (const SceneMaker& maker : makers) {
        runScene(maker, options, report);
    }
    std::printf("%s", report::table(report).c_str());
    if (!options.json.empty()) {
        report::writeText(options.json, report::json(report));
    }
    if (!options.pictures.empty()) {
        std::printf("\nPictures in %s\n", std::filesystem::absolute(options.pictures).c_str());
    }
    return report.holds() ? 0 : 1;
}

int runMain(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& end) {
        return app.exit(end) == 0 ? 0 : 2;
    }
    try {
        return body();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
        return 2;
    }
}

}  // namespace grapeshot::soft
