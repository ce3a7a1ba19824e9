#include "tracking_suite.hpp"

#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <report/machine.hpp>

#include "box_refit.hpp"
#include "fcl_model.hpp"
#include "tracking_bound.hpp"
#include "tracking_bullet.hpp"
#include "tracking_coils.hpp"
#include "tracking_depth.hpp"
#include "tracking_fit.hpp"
#include "tracking_front.hpp"
#include "tracking_meetings.hpp"
#include "tracking_scenes.hpp"
#include "tracking_truth.hpp"

namespace grapeshot::bench {

namespace {

struct SceneSpec {
    TrackingScene scene;
    int frames;
    int warmUp;  ///< frames that are not counted: nothing is tracked before the first
    TrackingBudget budget;
    std::function<TrackingFrame(const TrackingScene&, int frame, int frames)> at;
};

/// Least times of the repetitions, and what was found; per frame.
struct MethodRun {
    std::string name;
    std::vector<double> us;
    std::vector<double> work, coverage;
    std::vector<int> ages;  ///< of regions, with `found`
    std::vector<bool> found;
    double mismatches = 0;

    void time(std::size_t frame, double value) {
        if (us.size() <= frame) {
            us.push_back(value);
        } else {
            us[frame] = std::min(us[frame], value);
        }
    }
};

/// Share of the regions of an age that were found, and how many there were.
std::pair<double, double> recallAt(const MethodRun& run, int age) {
    double all = 0;
    double found = 0;
    for (std::size_t i = 0; i < run.ages.size(); ++i) {
        if (age == 0 || run.ages[i] == age) {
            ++all;
            found += run.found[i] ? 1 : 0;
        }
    }
    return {all > 0 ? found / all : report::notApplicable, all};
}

/// What a surface does, as far as the step is told.
struct Known {
    Stretch stretch;
    Displacement displacement;
};
const Known measuredBounds{Stretch::measured(), Displacement::measured()};

/// What a solver would know, with a little to spare.
Known givenBounds(const Surface& surface, const std::vector<Eigen::Vector3f>& before,
                  const std::vector<Eigen::Vector3f>& now) {
    constexpr float spare = 1.02F;
    return {Stretch::given(spare * measureStretch(surface, now)),
            Displacement::given(before.empty() ? 0 : spare * farthestMove(before, now))};
}

class SceneRun {
  public:
    SceneRun(const SceneSpec& spec, std::uint64_t seed) : m_spec(spec), m_treeA(buildBallTree(spec.scene.a.view())) {
        if (!spec.scene.isSelf()) {
            m_treeB = buildBallTree(spec.scene.b.view());
            m_boxesA = build(spec.scene.a.view());
            m_boxesB = build(spec.scene.b.view());
        }
        m_settings = settingsOf(spec.scene, spec.budget, seed);
    }

    void run(int repetitions) {
        for (int repetition = 0; repetition < repetitions; ++repetition) {
            runOnce(repetition == 0);
        }
    }

    /// Mean coverage of each of so many seeds, budget mode, bounds given; of a body with itself.
    [[nodiscard]] std::vector<double> coverageOfSeeds(std::uint64_t seeds) const {
        Tracker exact(m_treeA);
        std::vector<Tracker> trackers(seeds, exact);
        std::vector<double> sum(seeds, 0);
        TrackResult truth;
        TrackResult result;
        TrackingFrame before;
        for (int frame = 0; frame < m_spec.frames; ++frame) {
            const TrackingFrame where = m_spec.at(m_spec.scene, frame, m_spec.frames);
            const Known known = givenBounds(m_treeA.surface, before.a, where.a);
            before = where;
            TrackSettings settings = m_settings;
            settings.mode = TrackMode::exact;
            exact.step({where.a, {}, known.stretch, {}, {}}, settings, {}, truth);
            settings.mode = TrackMode::budget;
            for (std::uint64_t i = 0; i < seeds; ++i) {
                settings.seed = m_settings.seed + i;
                trackers[i].step({where.a, {}, known.stretch, {}, known.displacement}, settings,
                                 {.work = m_spec.budget.work}, result);
                if (frame >= m_spec.warmUp) {
                    sum[i] += coverage(truth.contacts, result.contacts, reportedCoil.tubeRadius) /
                              (m_spec.frames - m_spec.warmUp);
                }
            }
        }
        return sum;
    }

    [[nodiscard]] const MethodRun& of(const std::string& name) const { return m_runs.at(name); }
    [[nodiscard]] double mean(const std::string& name) const { return report::mean(m_runs.at(name).us); }

    void addRows(const std::string& peer, report::Report& results) const {
        for (const std::string& name : m_order) {
            const MethodRun& run = m_runs.at(name);
            report::Row row;
            row.scenario = m_spec.scene.isSelf() ? "self" : "bodies";
            row.mesh = m_spec.scene.name;
            row.triangles = m_spec.scene.a.triangles.size() + m_spec.scene.b.triangles.size();
            row.method = name;
            row.peer = peer;
            row.n = run.us.size();
            row.timeUs = report::quantiles(run.us);
            row.ratio = mean(peer) / row.timeUs.mean;
            if (!run.work.empty()) {
                row.work = {{"mean", report::mean(run.work)}, {"max", *std::ranges::max_element(run.work)}};
            }
            if (!run.coverage.empty()) {
                row.measured.emplace_back("coverage", report::mean(run.coverage));
                for (const int age : {1, 2, 4, 0}) {
                    if (m_spec.scene.isSelf()) {
                        break;  // one region from end to end
                    }
                    const auto [recall, count] = recallAt(run, age);
                    const std::string at = age == 0 ? "All" : std::to_string(age);
                    row.measured.emplace_back("recall" + at, recall);
                    row.measured.emplace_back("regions" + at, count);
                }
                row.measured.emplace_back("mismatches", run.mismatches);
            }
            results.rows.push_back(row);
        }
    }

  private:
    MethodRun& method(const std::string& name) {
        const auto [place, isNew] = m_runs.try_emplace(name);
        if (isNew) {
            place->second.name = name;
            m_order.push_back(name);
        }
        return place->second;
    }

    void step(Tracker& tracker, const TrackingFrame& where, const Known& knownA, const Known& knownB, TrackMode mode,
              const Budget& budget, TrackResult& out) const {
        TrackSettings settings = m_settings;
        settings.mode = mode;
        // Without look-ahead displacements are of no use at these speeds (see --scenario front).
        const bool looksAhead = mode == TrackMode::budget && settings.lookAhead > 0;
        const auto stateOf = [&](const std::vector<Eigen::Vector3f>& positions, const Known& known) {
            return SurfaceState{positions, {}, known.stretch, {}, looksAhead ? known.displacement : Displacement{}};
        };
        if (m_spec.scene.isSelf()) {
            tracker.step(stateOf(where.a, knownA), settings, budget, out);
        } else {
            tracker.step(stateOf(where.a, knownA), stateOf(where.b, knownB), settings, budget, out);
        }
    }

    void runOnce(bool score) {
        const bool self = m_spec.scene.isSelf();
        const auto makeTracker = [&] { return self ? Tracker(m_treeA) : Tracker(m_treeA, m_treeB); };
        struct Contender {
            const char* name;
            TrackMode mode;
            bool measured;
            std::uint64_t work;
            Tracker tracker;
        };
        std::vector<Contender> contenders{
            {"exact, bound given", TrackMode::exact, false, unlimited, makeTracker()},
            {"exact, bound measured", TrackMode::exact, true, unlimited, makeTracker()},
            {"resolution, bound given", TrackMode::resolution, false, unlimited, makeTracker()},
            {"budget, bound given", TrackMode::budget, false, m_spec.budget.work, makeTracker()},
            {"budget, bound measured", TrackMode::budget, true, m_spec.budget.work, makeTracker()}};
        std::optional<Query> query;
        if (!self) {
            query.emplace(m_boxesA, m_boxesB);
        }
        RegionHistory history(m_spec.scene.spacing);
        TrackResult truth;
        TrackResult result;
        Contacts contacts;
        TrackingFrame before;
        for (int frame = 0; frame < m_spec.frames; ++frame) {
            const TrackingFrame where = m_spec.at(m_spec.scene, frame, m_spec.frames);
            const Known givenA = givenBounds(m_treeA.surface, before.a, where.a);
            const Known givenB = self ? givenA : givenBounds(m_treeB.surface, before.b, where.b);
            before = where;
            const bool counted = frame >= m_spec.warmUp;
            const auto index = static_cast<std::size_t>(frame - m_spec.warmUp);
            std::size_t boxPairs = 0;
            if (!self) {
                const double begin = report::threadCpuUs();
                refitBoxes(m_boxesA, where.a);
                refitBoxes(m_boxesB, where.b);
                const double middle = report::threadCpuUs();
                query->contacts({}, {.maxDistance = m_spec.scene.maxDistance}, {}, contacts);
                const double end = report::threadCpuUs();
                boxPairs = contacts.pairs.size();
                if (counted) {
                    method("boxes refitted").time(index, end - begin);
                    method("boxes, traversal alone").time(index, end - middle);
                }
            }
            if (counted) {
                const double begin = report::threadCpuUs();
                m_sink += measureStretch(m_treeA.surface, where.a);
                m_sink += self ? 0 : measureStretch(m_treeB.surface, where.b);
                method("measuring alone").time(index, report::threadCpuUs() - begin);
            }
            for (Contender& one : contenders) {
                TrackResult& out = one.mode == TrackMode::exact && !one.measured ? truth : result;
                const double begin = report::threadCpuUs();
                step(one.tracker, where, one.measured ? measuredBounds : givenA, one.measured ? measuredBounds : givenB,
                     one.mode, {.work = one.work}, out);
                const double us = report::threadCpuUs() - begin;
                if (score && !self && &out == &truth) {
                    history.advance(truth.contacts, m_treeA.surface, m_treeB.surface);
                }
                if (!counted) {
                    continue;
                }
                MethodRun& run = method(one.name);
                run.time(index, us);
                if (score) {
                    run.work.push_back(static_cast<double>(out.work));
                    run.coverage.push_back(
                        coverage(truth.contacts, out.contacts, self ? reportedCoil.tubeRadius : m_spec.scene.spacing));
                    const std::vector<bool> found = history.found(out.contacts);
                    run.ages.insert(run.ages.end(), history.ages().begin(), history.ages().end());
                    run.found.insert(run.found.end(), found.begin(), found.end());
                    if (!self && one.mode == TrackMode::exact && out.contacts.size() != boxPairs) {
                        ++run.mismatches;
                    }
                }
            }
        }
    }

    const SceneSpec& m_spec;
    BallTree m_treeA, m_treeB;
    Tree m_boxesA, m_boxesB;
    TrackSettings m_settings;
    std::map<std::string, MethodRun> m_runs;
    std::vector<std::string> m_order;
    float m_sink = 0;
};

/// FCL's refit and its first contact, on a few frames of the scene: its refit is what takes the time.
void addFclRow(const SceneSpec& spec, double ourUs, report::Report& results) {
    FclModel a(spec.scene.a.view());
    FclModel b(spec.scene.b.view());
    std::vector<double> us;
    for (int frame = spec.frames / 2; frame < spec.frames / 2 + 3; ++frame) {
        const TrackingFrame where = spec.at(spec.scene, frame, spec.frames);
        const FclPoints pointsA(where.a);
        const FclPoints pointsB(where.b);
        const double begin = report::threadCpuUs();
        a.refit(pointsA);
        b.refit(pointsB);
        static_cast<void>(a.collides(b, {}));
        us.push_back(report::threadCpuUs() - begin);
    }
    report::Row row;
    row.scenario = "bodies";
    row.mesh = spec.scene.name;
    row.triangles = spec.scene.a.triangles.size() + spec.scene.b.triangles.size();
    row.method = "FCL OBBRSS refitted, first contact";
    row.peer = "boxes refitted";
    row.n = us.size();
    row.timeUs = report::quantiles(us);
    row.ratio = ourUs / row.timeUs.mean;
    results.rows.push_back(row);
}

SceneSpec bodiesSpec(const char* name, int frequency, int frames, const TrackingBudget& budget, std::uint64_t seed) {
    return {twoBodies(name, frequency, static_cast<std::uint32_t>(seed % 100'003)), frames, 2, budget,
            [](const TrackingScene& scene, int frame, int count) {
                return twoBodiesAt(scene, 0.08F, static_cast<float>(frame), count);
            }};
}

SceneSpec coilSpec(const char* name, std::size_t triangles, int frames, int warmUp) {
    return {coil(name, reportedCoil, triangles), frames, warmUp, coilBudget(reportedCoil),
            [](const TrackingScene& scene, int frame, int) {
                return coilAt(scene, reportedCoil, static_cast<float>(frame));
            }};
}

}  // namespace

report::Report runTrackingSuite(const Options& options) {
    const bool quick = options.quick;
    const int repetitions = options.repetitions.value_or(quick ? 1 : 3);
    report::Report results{.suite = "tracking", .seed = options.seed, .quick = quick, .rows = {}, .claims = {}};
    if (options.scenarios == std::vector<std::string>{"fit"}) {
        addFitRows(options.seed, quick, results);
        return results;
    }
    const auto wanted = [&](const char* scenario) {
        return options.scenarios.empty() || std::ranges::count(options.scenarios, scenario) > 0;
    };
    const auto claim = [&](std::string text, double value, bool atLeast, double bound) {
        results.claims.push_back({std::move(text), value, atLeast, bound});
    };
    if (wanted("bodies")) {
        const std::vector<SceneSpec> specs =
            quick ? std::vector<SceneSpec>{bodiesSpec("2x10k", 22, 30, withWork(bodiesBudget, 2'000), options.seed)}
                  : std::vector<SceneSpec>{bodiesSpec("2x100k", 70, 60, bodiesBudget, options.seed),
                                           bodiesSpec("2x1M", 224, 24, largeBodiesBudget, options.seed)};
        for (const SceneSpec& spec : specs) {
            std::cerr << spec.scene.name << " ...\n";
            SceneRun run(spec, options.seed);
            run.run(repetitions);
            run.addRows("boxes refitted", results);
            const std::string name = spec.scene.name;
            claim(name + ": frames whose exact pairs are not those of the boxes",
                  run.of("exact, bound given").mismatches + run.of("exact, bound measured").mismatches, false, 0);
            claim(name + ": regions at their first step, exact", recallAt(run.of("exact, bound given"), 1).first, true,
                  0.99);
            claim(name + ": regions of all ages, budget", recallAt(run.of("budget, bound given"), 0).first, true,
                  quick ? 0.7 : 0.98);
            if (quick) {
                continue;
            }
            const bool large = spec.scene.a.triangles.size() > 500'000;
            const double boxes = run.mean("boxes refitted");
            claim(name + ": boxes / exact, bound given", boxes / run.mean("exact, bound given"), true, large ? 15 : 3);
            claim(name + ": boxes / exact, bound measured", boxes / run.mean("exact, bound measured"), true, 3);
            if (large) {
                claim(name + ": boxes / budget, bound given", boxes / run.mean("budget, bound given"), true, 100);
                claim(name + ": boxes / budget, bound measured", boxes / run.mean("budget, bound measured"), true, 4);
            } else {
                addFclRow(spec, boxes, results);
            }
        }
    }
    if (wanted("bullet")) {
        addBulletRows(options, results);
    }
    if (wanted("meetings") && !quick) {
        const bool all = !options.poses;
        for (const MeetingSpec& spec : {MeetingSpec{"2x100k", 70, options.poses.value_or(120), bodiesBudget},
                                        MeetingSpec{"2x1M", 224, all ? 60 : *options.poses, largeBodiesBudget}}) {
            std::cerr << "meetings, " << spec.name << " ...\n";
            const MeetingResult met = addMeetingRows(spec, options.seed, results);
            const bool large = spec.budget.work == largeBodiesBudget.work;
            const std::string name = spec.name + ", meetings: ";
            claim(name + "steps whose exact pairs are not those of the boxes", met.mismatches, false, 0);
            if (large) {
                claim(name + "regions of all ages, budget", met.allFound, true, 0.98);
            } else {
                claim(name + "regions at their first step, budget", met.newFound, true, 0.99);
            }
            claim(name + "boxes / budget, bound given", met.timesFaster, true, large ? 100 : 3);
        }
    }
    if (wanted("self")) {
        const std::vector<SceneSpec> specs =
            quick ? std::vector<SceneSpec>{coilSpec("coil10k", 10'000, 24, 8)}
                  : std::vector<SceneSpec>{coilSpec("coil10k", 10'000, 40, 20), coilSpec("coil100k", 100'000, 40, 20),
                                           coilSpec("coil1M", 1'000'000, 30, 20)};
        std::vector<double> budgetUs;
        for (const SceneSpec& spec : specs) {
            std::cerr << spec.scene.name << " ...\n";
            SceneRun run(spec, options.seed);
            run.run(std::min(repetitions, 2));
            run.addRows("exact, bound given", results);
            const std::string name = spec.scene.name;
            const MethodRun& budget = run.of("budget, bound given");
            budgetUs.push_back(run.mean("budget, bound given"));
            claim(name + ": worst frame / mean, work of the budget mode",
                  *std::ranges::max_element(budget.work) / report::mean(budget.work), false, 3);
            claim(name + ": coverage at resolution", report::mean(run.of("resolution, bound given").coverage), true,
                  0.999);
            const std::size_t triangles = spec.scene.a.triangles.size();
            if (quick || triangles < 50'000) {
                continue;
            }
            const bool large = triangles > 500'000;
            if (!large) {
                constexpr std::uint64_t seeds = 6;
                const std::vector<double> covered = run.coverageOfSeeds(seeds);
                const double worst = *std::ranges::min_element(covered);
                report::Row row;
                row.scenario = "self";
                row.mesh = name;
                row.triangles = triangles;
                row.method = "budget, bound given, six seeds";
                row.n = seeds * static_cast<std::size_t>(spec.frames - spec.warmUp);
                row.measured = {{"coverage", report::mean(covered)}, {"coverageOfWorstSeed", worst}};
                results.rows.push_back(row);
                claim(name + ": coverage at one tube radius, budget, worst of six seeds", worst, true, 0.995);
            }
            claim(name + ": coverage at one tube radius, budget", report::mean(budget.coverage), true,
                  large ? 0.97 : 0.995);
            claim(name + ": exact / budget", run.mean("exact, bound given") / budgetUs.back(), true, large ? 40 : 8);
        }
        if (!quick) {
            claim("coil, one budget: time at 1M / time at 10k", budgetUs.back() / budgetUs.front(), false, 1.1);
        }
    }
    if (wanted("front")) {
        std::cerr << "front ...\n";
        addFrontRows(options.seed, quick, results);
    }
    if (wanted("bound")) {
        std::cerr << "bound ...\n";
        addBoundRows(options.seed, options.poses.value_or(quick ? 600 : 10'000), results);
    }
    if (wanted("depth")) {
        std::cerr << "depth ...\n";
        addDepthRows(options.seed, quick, std::min(options.poses.value_or(quick ? 4 : 12), 100), results);
    }
    return results;
}

}  // namespace grapeshot::bench
