// `grapeshot run FILE.bullet`: a scene from a file, stepped with our contacts, and beside it with somebody else's.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <import/bullet_scene.hpp>
#include <memory>
#include <optional>

#include <report/machine.hpp>
#include <report/report.hpp>
#include <report/text_file.hpp>

#include "commands.hpp"

namespace grapeshot::cli {
namespace {

using scenes::Engine;

struct RunOptions {
    std::string file;
    std::string against;
    int steps = 300;
    double timeStep = 1.0 / 60;  ///< s
    std::uint64_t budget = unlimited;
    int threads = 1;
    std::string jsonFile;
};

/// One world, step by step.
class Series {
  public:
    Series(const RunOptions& options, Engine engine, const Settings& settings)
        : m_options(options), m_engine(engine), m_scene(options.file, engine, settings) {}

    void step() {
        m_scene.dispatcher().resetClock();
        m_scene.world().stepSimulation(btScalar(m_options.timeStep), 0);
        m_timeUs.push_back(1e6 * m_scene.dispatcher().seconds());
        int contacts = 0;
        for (int i = 0; i < m_scene.dispatcher().getNumManifolds(); ++i) {
            contacts += m_scene.dispatcher().getManifoldByIndexInternal(i)->getNumContacts();
        }
        m_contacts += contacts;
        const StepStatistics& s = statistics(&m_scene.dispatcher());
        m_work += static_cast<double>(s.work);
        m_degraded += s.degraded;
    }

    [[nodiscard]] report::Row row() {
        report::Row row;
        row.scenario = std::filesystem::path(m_options.file).filename().string();
        row.method = std::string(name(m_engine));
        row.n = m_timeUs.size();
        row.timeUs = report::quantiles(m_timeUs);
        const auto n = static_cast<double>(std::max<std::size_t>(1, m_timeUs.size()));
        row.work = {{"contacts/step", m_contacts / n}};
        if (m_engine == Engine::grapeshot) {
            row.work.emplace_back("units/step", m_work / n);
            row.work.emplace_back("cut short/step", m_degraded / n);
        }
        row.measured = {{"bodies", static_cast<double>(m_scene.summary().bodies)},
                        {"rms speed m/s", rmsSpeed()},
                        {"asleep", asleep()}};
        return row;
    }

    /// Bodies whose pose is no number.
    [[nodiscard]] double broken() {
        double count = 0;
        forEachBody([&](const btRigidBody& body) {
            const btVector3& at = body.getWorldTransform().getOrigin();
            count += std::isfinite(at.x()) && std::isfinite(at.y()) && std::isfinite(at.z()) ? 0 : 1;
        });
        return count;
    }
    [[nodiscard]] const import::BulletSceneSummary& summary() const { return m_scene.summary(); }

  private:
    template <class Visit>
    void forEachBody(Visit&& visit) {
        const btCollisionObjectArray& objects = m_scene.world().getCollisionObjectArray();
        for (int i = 0; i < objects.size(); ++i) {
            const btRigidBody* body = btRigidBody::upcast(objects[i]);
            if (body != nullptr && !body->isStaticOrKinematicObject()) {
                visit(*body);
            }
        }
    }
    [[nodiscard]] double rmsSpeed() {
        double sum = 0;
        double count = 0;
        forEachBody([&](const btRigidBody& body) {
            sum += static_cast<double>(body.getLinearVelocity().length2());
            ++count;
        });
        return count > 0 ? std::sqrt(sum / count) : 0;
    }
    [[nodiscard]] double asleep() {
        double count = 0;
        forEachBody([&](const btRigidBody& body) { count += body.isActive() ? 0 : 1; });
        return count;
    }

    const RunOptions& m_options;
    Engine m_engine;
    import::BulletScene m_scene;
    std::vector<double> m_timeUs;
    double m_contacts = 0, m_work = 0, m_degraded = 0;
};

report::Report runBoth(const RunOptions& options) {
    Settings settings;
    settings.frameBudget.work = options.budget;
    settings.threads = options.threads;
    Series ours(options, Engine::grapeshot, settings);
    std::optional<Series> theirs;
    if (!options.against.empty()) {
        theirs.emplace(options, options.against == "gimpact" ? Engine::gimpact : Engine::none, Settings());
    }
    const import::BulletSceneSummary& s = ours.summary();
    std::printf("%s: %d bodies, %d of them moving, %d mesh shapes (%d GImpact), %d constraints\n", options.file.c_str(),
                s.bodies, s.moving, s.meshShapes, s.gimpactShapes, s.constraints);
    if (s.droppedBodies > 0) {
        std::printf("%d bodies were left out: nobody restores their shapes\n", s.droppedBodies);
    }
    for (int i = 0; i < options.steps; ++i) {
        ours.step();
        if (theirs) {
            theirs->step();
        }
    }
    report::Report result;
    result.suite = "run";
    result.rows = {ours.row()};
    if (theirs) {
        result.rows.push_back(theirs->row());
        result.rows[0].peer = result.rows[1].method;
        result.rows[0].ratio = result.rows[1].timeUs.mean / result.rows[0].timeUs.mean;
    }
    result.claims = {{"bodies whose pose is no number", ours.broken(), false, 0}};
    return result;
}

ExitCode runFile(const RunOptions& options) {
    const report::Report result = runBoth(options);
    std::fputs(table(result).c_str(), stdout);
    if (!options.jsonFile.empty()) {
        report::writeText(options.jsonFile, json(result));
    }
    return result.holds() ? done : claimFailed;
}

}  // namespace

void addRun(CLI::App& tool, std::function<ExitCode()>& run) {
    auto* command = tool.add_subcommand("run", "Steps a scene from a .bullet file and says what its contacts cost");
    auto options = std::make_shared<RunOptions>();
    command->add_option("FILE", options->file, ".bullet file, as Bullet's serializer writes it")->required();
    command->add_option("--against", options->against, "step it with these contacts too, in turns")
        ->check(CLI::IsMember({"gimpact", "none"}));
    command->add_option("--steps", options->steps, "how many")->check(CLI::Range(1, 1'000'000))->capture_default_str();
    command->add_option("--dt", options->timeStep, "length of a step, s")
        ->check(CLI::Range(1e-6, 1.0))
        ->capture_default_str();
    command->add_option("--budget", options->budget, "work units per step")->check(CLI::NonNegativeNumber);
    command->add_option("--threads", options->threads, "that compute contacts")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    command->add_option("--json", options->jsonFile, "also write the rows here");
    command->callback([options, &run] { run = [options] { return runFile(*options); }; });
}

}  // namespace grapeshot::cli
