#include "scene_budget.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

#include "pile_scene.hpp"
#include "scene_rows.hpp"
#include "scene_run.hpp"

namespace grapeshot::bench {

namespace {

constexpr double shares[] = {1.0 / 2, 1.0 / 4, 1.0 / 8, 1.0 / 20};
constexpr double rivalShares[] = {1.0 / 4, 1.0 / 20};
constexpr double deepestUnbudgeted = 0.01;  ///< p99 / radius, as for the scenario `pile`
constexpr std::size_t proxyTriangles[] = {1000, 500};
constexpr double fallSeconds = 2;  ///< in which the bodies fall onto each other

double timeStepOf(const Outcome& outcome) {
    return outcome.method.world.timeStep;
}

template <class Value>
double meanOf(const std::vector<Outcome>& outcomes, Value&& value) {
    double sum = 0;
    for (const Outcome& outcome : outcomes) {
        sum += value(outcome);
    }
    return sum / static_cast<double>(outcomes.size());
}

/// The same pile from several starts.
class Piles {
  public:
    Piles(const Options& options, double margin, report::Report& results)
        : m_options(options), m_results(results), m_label(atMargin(margin)) {
        m_settings.margin = margin;
        m_starts = options.repetitions.value_or(options.quick ? 1 : 3);
        if (options.quick) {
            m_settings.bodies = 10;
            m_settings.trianglesPerBody = 1200;
            m_seconds = 1.5;
        }
    }

    [[nodiscard]] double seconds() const { return m_seconds; }

    /// One method, from every start.
    [[nodiscard]] std::vector<Outcome> run(const SceneMethod& method) const { return run(method, m_starts); }

    /// The same from the first `starts` alone.
    [[nodiscard]] std::vector<Outcome> run(const SceneMethod& method, int starts) const {
        std::cerr << "budget, " << m_label << ": " << method.name << '\n';
        std::vector<Outcome> outcomes;
        for (int start = 0; start < starts; ++start) {
            PileSettings settings = m_settings;
            settings.seed = m_options.seed + static_cast<std::uint64_t>(start);
            const Course course{.scenario = "budget", .seconds = m_seconds, .progress = false};
            std::vector<Outcome> one = runInTurns(
                course, {method}, [&](const scenes::WorldSettings& world) { return makePile(world, settings); });
            outcomes.push_back(std::move(one.front()));
        }
        return outcomes;
    }

    /// The same, judged, as a row.
    Quality judged(const SceneMethod& method) {
        const std::vector<Outcome> outcomes = run(method);
        std::vector<const Outcome*> starts;
        for (const Outcome& outcome : outcomes) {
            starts.push_back(&outcome);
        }
        const Quality quality = judge(starts);
        report::Row row = rowOf("budget", m_label, outcomes.front(), quality);
        row.measured.emplace_back("starts", m_starts);
        row.measured.emplace_back("workOfFall", meanOf(outcomes, [](const Outcome& outcome) {
                                      return meanWork(outcome.recorder.run(), timeStepOf(outcome), 0, fallSeconds);
                                  }));
        row.measured.emplace_back("workMostHalfSecond", meanOf(outcomes, [](const Outcome& outcome) {
                                      return mostWork(outcome.recorder.run(), timeStepOf(outcome), 0.5);
                                  }));
        const auto budget = static_cast<double>(method.world.settings.frameBudget.work);
        if (method.world.settings.frameBudget.work != unlimited) {
            row.measured.emplace_back("workOfBudget", quality.workMean / budget);
        }
        m_results.rows.push_back(row);
        return quality;
    }

  private:
    const Options& m_options;
    report::Report& m_results;
    std::string m_label;
    PileSettings m_settings;
    double m_seconds = 12;
    int m_starts = 1;
};

std::string shareName(double share) {
    return std::string("1/").append(std::to_string(std::lround(1 / share)));
}

/// Whoever does not fall asleep took the whole time.
double sleepSeconds(const Quality& quality, double whole) {
    return std::isnan(quality.secondsToSleep) ? whole : quality.secondsToSleep;
}

/// The slice per pair with which plain round robin does as much work on the whole: not less than ours, within some
/// percent, in the first start.
std::uint64_t equalSlice(const Piles& piles, double work) {
    double slice = std::max(1.0, work / 100);
    for (int attempt = 0; attempt < 4; ++attempt) {
        const SceneMethod method = roundRobin(1, static_cast<std::uint64_t>(std::lround(slice)));
        const double got = meanWorkAwake(piles.run(method, 1).front());
        if (got >= work && got < 1.1 * work) {
            break;
        }
        slice = std::max(1.0, slice * std::clamp(1.05 * work / got, 0.25, 4.0));
    }
    return static_cast<std::uint64_t>(std::lround(slice));
}

void compare(const std::string& rival, const Quality& ours, const Quality& theirs, double whole, Claims& claims) {
    claims.atMost("p99 depth / radius - that of " + rival, ours.bodyDepth.p99 - theirs.bodyDepth.p99, 0);
    claims.atMost("seconds to sleep - those of " + rival, sleepSeconds(ours, whole) - sleepSeconds(theirs, whole), 0);
    claims.atMost("bodies lost - those of " + rival, ours.lost - theirs.lost, 0);
}

void runAt(double margin, const Options& options, report::Report& results) {
    Piles piles(options, margin, results);
    const Quality full = piles.judged(grapeshotMethod(1));
    if (!options.quick) {
        // What coarser meshes need without a budget: is a quarter within their reach?
        for (const std::size_t triangles : proxyTriangles) {
            static_cast<void>(piles.judged(decimatedMethod(1, triangles)));
        }
    }
    for (const double share : shares) {
        const auto budget = static_cast<std::uint64_t>(std::lround(share * full.workMean));
        SceneMethod method = budgeted(grapeshotMethod(1), budget);
        method.name.append(" ").append(shareName(share));
        const Quality ours = piles.judged(method);
        Claims claims("budget " + shareName(share) + ", " + atMargin(margin), results);
        claims.atMost("bodies lost", ours.lost, 0);
        claims.atMost("work of a step beyond max(budget, mandatory slices)", ours.workBeyondBudget, 0);
        claims.atMost("energy over the initial, %", ours.energyOverInitialPercent, 0.5);
        if (share >= 0.25 && !options.quick) {
            // Unbudgeted it is often 0: then the limit for an unbudgeted pile counts.
            claims.atMost("p99 of true penetration / radius", ours.bodyDepth.p99,
                          2 * std::max(full.bodyDepth.p99, deepestUnbudgeted));
        }
        if (share < 0.1) {
            claims.atLeast("mean pairs of a step reported as cut short", ours.degradedMean, 0.01);
        }
        if (options.quick || std::ranges::find(rivalShares, share) == std::end(rivalShares)) {
            continue;
        }
        const auto rival = [&](SceneMethod other, const std::string& name) {
            other.name = name + " " + shareName(share);
            compare(other.name, ours, piles.judged(other), piles.seconds(), claims);
        };
        for (const std::size_t triangles : proxyTriangles) {
            const SceneMethod proxy = decimatedMethod(1, triangles);
            rival(budgeted(proxy, budget), proxy.name);
        }
        rival(budgeted(halvedRate(grapeshotMethod(1)), 2 * budget), "halved rate");
        rival(roundRobin(1, equalSlice(piles, ours.workMean)), "round robin");
    }
    if (options.quick) {  // that they run at all
        const auto budget = static_cast<std::uint64_t>(std::lround(full.workMean / 4));
        static_cast<void>(piles.judged(budgeted(decimatedMethod(1, 300), budget)));
        static_cast<void>(piles.judged(budgeted(halvedRate(grapeshotMethod(1)), 2 * budget)));
        static_cast<void>(piles.judged(roundRobin(1, equalSlice(piles, full.workMean / 4))));
    }
}

}  // namespace

void runBudget(const Options& options, report::Report& results) {
    for (const double margin : sceneMargins) {
        runAt(margin, options, results);
        if (options.quick) {
            break;
        }
    }
}

}  // namespace grapeshot::bench
