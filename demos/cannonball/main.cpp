// `cannonball`: the same shot with GImpact and with Grapeshot, and the many paths that it might have taken.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <import/mesh_import.hpp>
#include <report/report.hpp>
#include <report/text_file.hpp>

#include "pictures.hpp"
#include "shot.hpp"

namespace grapeshot::cannonball {
namespace {

constexpr double perturbation = 1e-4;  // relative, of velocity and spin: 2 mm/s at 20 m/s
constexpr std::size_t judgedStride = 6;

struct Options {
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/cannonball";
    std::filesystem::path json;
    std::vector<std::filesystem::path> meshes;
    std::string engine = "both";
    std::string ground = "plane";
    int steps = 360;
    int paths = 12;
    double detail = 2;
};

/// A bar on a terminal, nothing elsewhere.
class Progress {
  public:
    explicit Progress(std::size_t total)
        : m_total(std::max<std::size_t>(total, 1)), m_shown(isatty(STDERR_FILENO) == 1) {}
    ~Progress() { end(); }

    void advance(const char* what) {
        ++m_done;
        const std::size_t percent = 100 * m_done / m_total;
        if (m_shown && percent != m_percent) {
            m_percent = percent;
            const std::string bar(percent / 4, '#');
            std::fprintf(stderr, "\r[%-25s] %3zu %%  %-40s", bar.c_str(), percent, what);
            std::fflush(stderr);
        }
    }
    void end() {
        if (m_shown) {
            std::fprintf(stderr, "\r%80s\r", "");
        }
        m_shown = false;
    }

  private:
    std::size_t m_total;
    std::size_t m_done = 0;
    std::size_t m_percent = 101;
    bool m_shown;
};

struct Result {
    std::vector<std::unique_ptr<Shot>> shots;  ///< GImpact before Grapeshot
    std::vector<Depths> depthsOfShots;
    std::vector<Paths> paths;  ///< the last shot's own, then the perturbed ones
};

std::vector<scenes::Engine> enginesOf(const Options& options) {
    std::vector<scenes::Engine> engines;
    if (options.engine != "grapeshot") {
        engines.push_back(scenes::Engine::gimpact);
    }
    if (options.engine != "gimpact") {
        engines.push_back(scenes::Engine::grapeshot);
    }
    return engines;
}

Paths pathsOf(const Shot& shot) {
    Paths paths;
    for (std::size_t ball = 0; ball < shot.scene.balls.size(); ++ball) {
        paths.push_back(path(shot, ball));
    }
    return paths;
}

Result run(const Options& options, scenes::CannonballSettings settings) {
    const std::vector<scenes::Engine> engines = enginesOf(options);
    const auto steps = static_cast<std::size_t>(options.steps);
    Progress progress(steps * (1 + static_cast<std::size_t>(options.paths)));
    Result result;
    for (const scenes::Engine engine : engines) {
        settings.engine = engine;
        result.shots.push_back(std::make_unique<Shot>(settings));
    }
    // Step by step in turns, so that what else the machine does hits both alike.
    for (std::size_t step = 0; step < steps; ++step) {
        for (const auto& shot : result.shots) {
            shot->advance();
        }
        progress.advance(engines.size() > 1 ? "GImpact and Grapeshot in turns" : "the shot");
    }
    result.paths.push_back(pathsOf(*result.shots.back()));
    settings.perturbation = perturbation;
    for (int i = 0; i < options.paths; ++i) {
        settings.seed = options.seed + static_cast<std::uint64_t>(i);
        Shot shot(settings);
        for (std::size_t step = 0; step < steps; ++step) {
            shot.advance();
            progress.advance("plausible paths");
        }
        result.paths.push_back(pathsOf(shot));
    }
    progress.end();
    for (const auto& shot : result.shots) {
        result.depthsOfShots.push_back(depths(*shot, judgedStride));
    }
    return result;
}

struct Summary {
    double step = 0, narrowphase = 0, contacts = 0, manifolds = 0;  ///< means; s and counts
    report::Quantiles stepUs;
    double share() const { return narrowphase / step; }
};

Summary summaryOf(const Shot& shot) {
    Summary summary;
    std::vector<double> times;
    const auto n = static_cast<double>(shot.records.size());
    for (const scenes::StepRecord& record : shot.records) {
        times.push_back(1e6 * record.cpuSeconds);
        summary.step += record.cpuSeconds / n;
        summary.narrowphase += record.narrowphaseCpuSeconds / n;
        summary.contacts += record.contacts / n;
        summary.manifolds += record.manifolds / n;
    }
    summary.stepUs = report::quantiles(times);
    return summary;
}

double energy(const scenes::StepRecord& record) {
    return record.kineticEnergy + record.potentialEnergy;
}

report::Report reportOf(const Options& options, const Result& result) {
    report::Report report{.suite = "cannonball", .seed = options.seed, .quick = false, .rows = {}, .claims = {}};
    for (std::size_t i = 0; i < result.shots.size(); ++i) {
        const Shot& shot = *result.shots[i];
        const Summary summary = summaryOf(shot);
        const scenes::StepRecord& last = shot.records.back();
        report::Row row;
        row.scenario = "cannonball, " + options.ground;
        row.mesh = "all moving";
        row.triangles = shot.scene.triangles;
        row.method = scenes::name(shot.scene.world.settings().engine);
        row.n = shot.records.size();
        row.timeUs = summary.stepUs;
        row.work = {{"contacts", summary.contacts}, {"manifolds", summary.manifolds}};
        row.measured = {{"narrowphaseMeanUs", 1e6 * summary.narrowphase},
                        {"narrowphaseShare", summary.share()},
                        {"deepestPenetrationMm", 1e3 * result.depthsOfShots[i].deepest},
                        {"p99PenetrationMm", 1e3 * result.depthsOfShots[i].p99},
                        {"lost", static_cast<double>(last.lost)},
                        {"kineticEnergyEndJ", last.kineticEnergy},
                        {"energyEndShare", energy(last) / energy(shot.records.front())}};
        if (i > 0) {
            row.peer = "gimpact";
            row.ratio = summaryOf(*result.shots.front()).narrowphase / summary.narrowphase;
            report.claims.push_back({"narrowphase of GImpact / of Grapeshot", row.ratio, true, 1});
        }
        report.rows.push_back(row);
        if (shot.scene.world.settings().engine == scenes::Engine::grapeshot) {
            report.claims.push_back({"bodies lost by Grapeshot", static_cast<double>(last.lost), false, 0});
            report.claims.push_back(
                {"energy at the end / at the start, Grapeshot", energy(last) / energy(shot.records.front()), false, 1});
        }
    }
    const std::vector<double> spread = spreads(result.paths);
    for (std::size_t ball = 0; ball < spread.size(); ++ball) {
        report::Row row;
        row.scenario = "plausible paths";
        row.mesh = result.shots.back()->scene.ballNames[ball];
        row.method = scenes::name(result.shots.back()->scene.world.settings().engine);
        row.n = result.paths.size();
        row.measured = {{"spreadAtEndM", spread[ball]}};
        report.rows.push_back(row);
    }
    return report;
}

void print(const Options& options, const Result& result, const report::Report& report) {
    const Shot& first = *result.shots.front();
    std::printf("Cannonball: %zu cannonballs at %zu blocks, %zu triangles, %d steps of 1/120 s on a %s.\n",
                first.scene.balls.size(), first.scene.blocks.size(), first.scene.triangles, options.steps,
                options.ground.c_str());
    std::printf("Times are processor time of the one thread.\n\n");
    std::printf("  %-10s %9s %9s %9s %12s %9s %12s %6s %12s\n", "", "mean", "p95", "worst", "narrowphase", "contacts",
                "deepest true", "bodies", "energy left");
    std::printf("  %-10s %9s %9s %9s %12s %9s %12s %6s %12s\n", "", "ms/step", "ms", "ms", "share", "mean",
                "penetration", "lost", "at the end");
    for (std::size_t i = 0; i < result.shots.size(); ++i) {
        const Shot& shot = *result.shots[i];
        const Summary summary = summaryOf(shot);
        std::printf("  %-10s %9.2f %9.2f %9.2f %10.0f %% %9.1f %9.1f mm %6d %10.1f %%\n",
                    std::string(scenes::title(shot.scene.world.settings().engine)).c_str(), 1e3 * summary.step,
                    1e-3 * summary.stepUs.p95, 1e-3 * summary.stepUs.max, 100 * summary.share(), summary.contacts,
                    1e3 * result.depthsOfShots[i].deepest, shot.records.back().lost,
                    100 * energy(shot.records.back()) / energy(shot.records.front()));
    }
    if (result.shots.size() > 1) {
        const Summary gimpact = summaryOf(*result.shots[0]);
        const Summary grapeshot = summaryOf(*result.shots[1]);
        std::printf("\n  Grapeshot's narrowphase takes 1/%.1f of GImpact's time, its whole step 1/%.1f.\n",
                    gimpact.narrowphase / grapeshot.narrowphase, gimpact.step / grapeshot.step);
    }
    if (options.paths > 0) {
        std::printf(
            "\n  Plausible paths: the shot again %d times, velocities and spins changed by 1e-4. At the end the\n"
            "  balls lie apart by (root mean square):\n",
            options.paths);
        const std::vector<double> spread = spreads(result.paths);
        for (std::size_t ball = 0; ball < spread.size(); ++ball) {
            std::printf("    %-26s %6.2f m\n", first.scene.ballNames[ball].c_str(), spread[ball]);
        }
    }
    std::printf("\n");
    for (const report::Claim& claim : report.claims) {
        std::printf("  %s  %s: %.3g (%s %g)\n", claim.holds() ? "ok    " : "FAILED", claim.claim.c_str(), claim.value,
                    claim.atLeast ? "at least" : "at most", claim.bound);
    }
}

void savePictures(const Options& options, const Result& result) {
    std::vector<const Shot*> shots;
    std::vector<Panel> impact;
    std::vector<Panel> end;
    for (const auto& shot : result.shots) {
        const std::string engine(scenes::title(shot->scene.world.settings().engine));
        const double timeStep = shot->scene.world.settings().timeStep;
        const std::size_t last = shot->frames.size() - 1;
        const std::size_t after = std::min(last, shot->firstImpact + 18);  // 0.15 s into it
        const auto title = [&](std::size_t frame) {
            char text[64];
            std::snprintf(text, sizeof text, "%s, %.2f s", engine.c_str(), timeStep * static_cast<double>(frame));
            return std::string(text);
        };
        shots.push_back(shot.get());
        impact.push_back({shot.get(), after, title(after)});
        end.push_back({shot.get(), last, title(last)});
    }
    const std::filesystem::path& out = options.out;
    sideBySide({{shots.front(), 0, "Start"}}).save(out / "start.png");
    sideBySide(impact).save(out / "impact.png");
    sideBySide(end).save(out / "end.png");
    stepTimes(shots).save(out / "step_time.png");
    withPaths(*shots.back(), result.paths,
              std::to_string(result.paths.size()) + " plausible paths of each cannonball (" +
                  std::string(scenes::title(shots.back()->scene.world.settings().engine)) + ")")
        .save(out / "scene.png");
}

int demo(const Options& options) {
    scenes::CannonballSettings settings;
    settings.detail = options.detail;
    settings.meshGround = options.ground == "mesh";
    for (const std::filesystem::path& file : options.meshes) {
        settings.furtherBalls.push_back(import::importMesh(file));
    }
    std::filesystem::create_directories(options.out);
    const Result result = run(options, settings);
    const report::Report report = reportOf(options, result);
    print(options, result, report);
    savePictures(options, result);
    report::writeText(options.out / "result.json", report::json(report));
    if (!options.json.empty()) {
        report::writeText(options.json, report::json(report));
    }
    const std::string folder = std::filesystem::absolute(options.out).lexically_normal().string();
    std::printf(
        "\nPictures in %s:\n"
        "  scene.png      the end, with all paths of the cannonballs\n"
        "  start.png, impact.png, end.png\n"
        "  step_time.png  time per step\n"
        "  result.json    the numbers\n",
        folder.c_str());
    return report.holds() ? 0 : 1;
}

}  // namespace
}  // namespace grapeshot::cannonball

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): what CLI11 says of wrong declarations
    using namespace grapeshot::cannonball;
    Options options;
    CLI::App app(
        "Non-convex cannonballs against a wall and towers of non-convex blocks: the same scene with GImpact and with\n"
        "Grapeshot, and the paths that the balls might have taken. Exit code: 0, 1 (a claim failed), 2 (bad use).",
        "cannonball");
    app.add_option("--seed", options.seed, "of the perturbations")->capture_default_str();
    app.add_option("--json", options.json, "also write the numbers to this file");
    app.add_option("--out", options.out, "folder for pictures and numbers")->capture_default_str();
    app.add_option("--steps", options.steps, "of 1/120 s")->check(CLI::Range(1, 100000))->capture_default_str();
    app.add_option("--paths", options.paths, "perturbed repetitions")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    app.add_option("--mesh", options.meshes, "a mesh file to be shot too (OBJ, STL, PLY, glTF, ...); may be repeated");
    app.add_option("--engine", options.engine, "which collision detection")
        ->check(CLI::IsMember({"both", "gimpact", "grapeshot"}))
        ->capture_default_str();
    app.add_option("--ground", options.ground, "what the scene stands on")
        ->check(CLI::IsMember({"plane", "mesh"}))
        ->capture_default_str();
    app.add_option("--detail", options.detail, "fineness of the meshes; triangles grow with its square")
        ->check(CLI::Range(0.5, 20.0))
        ->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& end) {
        return app.exit(end) == 0 ? 0 : 2;
    }
    try {
        return demo(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cannonball: %s\n", error.what());
        return 2;
    }
}
