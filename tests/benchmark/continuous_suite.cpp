#include "continuous_suite.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/scf/continuous.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <report/machine.hpp>
#include <support/impact_oracle.hpp>

#include "continuous_scenes.hpp"
#include "fcl_model.hpp"
#include "tracking_scenes.hpp"

namespace grapeshot::bench {

namespace {

constexpr float tolerance = 1e-6F;  // m, of scenes of diagonal 1

/// What one method says of a list of events.
struct ImpactAnswers {
    std::string name;
    std::vector<double> us, work;
    std::size_t misses = 0, falseHits = 0, late = 0;
    std::size_t judged = 0;                ///< events with a truth
    std::optional<std::size_t> uncertain;  ///< of methods that say whether they are certain
    double worstTime = 0;                  ///< |time - truth| / what is allowed
    bool hasTime = true;

    void note(const ImpactResult& result) {
        work.push_back(static_cast<double>(result.work));
        uncertain = uncertain.value_or(0) + (result.certain ? 0 : 1);
    }
    void judge(std::optional<double> time, double truth, double allowed) {
        ++judged;
        misses += !time && truth != test::noImpact ? 1 : 0;
        falseHits += time && truth == test::noImpact ? 1 : 0;
        if (time && truth != test::noImpact && hasTime) {
            worstTime = std::max(worstTime, std::abs(*time - truth) / allowed);
            late += std::abs(*time - truth) > allowed ? 1 : 0;
        }
    }
};

report::Row rowOf(const std::string& scenario, const std::string& mesh, std::size_t triangles,
                  const ImpactAnswers& answers, const ImpactAnswers& peer, std::size_t colliding) {
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh;
    row.triangles = triangles;
    row.method = answers.name;
    row.peer = peer.name;
    row.n = answers.us.size();
    if (answers.judged > 0) {
        row.falseNegatives = static_cast<double>(answers.misses);
        row.falsePositives = static_cast<double>(answers.falseHits);
    }
    row.colliding = static_cast<double>(colliding);
    row.timeUs = report::quantiles(answers.us);
    row.ratio = report::mean(peer.us) / row.timeUs.mean;
    if (!answers.work.empty()) {
        row.work = {{"mean", report::mean(answers.work)},
                    {"p99", report::quantile(answers.work, 0.99)},
                    {"max", *std::ranges::max_element(answers.work)}};
    }
    if (answers.hasTime && answers.judged > 0) {
        row.measured = {{"timesOff", static_cast<double>(answers.late)}, {"worstTimeOverAllowed", answers.worstTime}};
    }
    if (answers.uncertain) {
        row.measured.emplace_back("uncertain", static_cast<double>(*answers.uncertain));
    }
    return row;
}

template <class Call>
auto timed(ImpactAnswers& answers, Call&& call) {
    const double begin = report::threadCpuUs();
    auto result = call();
    answers.us.push_back(report::threadCpuUs() - begin);
    return result;
}

/// @return units that it took
std::uint64_t askWith(ImpactAnswers& answers, ImpactQuery& query, const SurfaceMotion& a, const SurfaceMotion& b,
                      const ImpactSettings& settings, std::uint64_t work, double truth, double allowed) {
    const ImpactResult result = timed(answers, [&] { return query.find(a, b, settings, {.work = work}); });
    answers.note(result);
    answers.judge(result.impact ? std::optional(static_cast<double>(result.impact->time)) : std::nullopt, truth,
                  allowed);
    return result.work;
}

/// Of what a search without a budget takes of the same event.
struct WorkShare {
    const char* name;
    double share;
};
constexpr std::array workShares{WorkShare{"1/10 of the work", 0.1}, WorkShare{"1/4 of the work", 0.25},
                                WorkShare{"1/2 of the work", 0.5}};

/// What an event is worth when only a share of its work may be done.
class RecallOverBudget {
  public:
    RecallOverBudget() {
        for (const WorkShare& one : workShares) {
            m_answers.emplace_back().name = one.name;
        }
    }
    void ask(ImpactQuery& query, const SurfaceMotion& a, const SurfaceMotion& b, const ImpactSettings& settings,
             std::uint64_t wholeWork, double truth, double allowed) {
        for (std::size_t i = 0; i < workShares.size(); ++i) {
            const auto work = static_cast<std::uint64_t>(workShares[i].share * static_cast<double>(wholeWork));
            askWith(m_answers[i], query, a, b, settings, work, truth, allowed);
        }
    }
    [[nodiscard]] const std::vector<ImpactAnswers>& answers() const { return m_answers; }

  private:
    std::vector<ImpactAnswers> m_answers;
};

std::vector<Eigen::Vector3f> between(const std::vector<Eigen::Vector3f>& before,
                                     const std::vector<Eigen::Vector3f>& now, float time) {
    std::vector<Eigen::Vector3f> result;
    for (std::size_t i = 0; i < before.size(); ++i) {
        result.emplace_back(before[i] + time * (now[i] - before[i]));
    }
    return result;
}

/// Do they overlap at one of so many moments? What making the positions takes is not timed.
std::optional<double> bySubsteps(ImpactAnswers& answers, Tracker& tracker, const TunnelEvent& event,
                                 const Stretch& stretch, int substeps) {
    TrackSettings settings;
    settings.mode = TrackMode::exact;
    settings.maxDistance = tolerance;
    double us = 0;
    double work = 0;
    std::optional<double> found;
    for (int i = 1; i <= substeps && !found; ++i) {
        const float time = static_cast<float>(i) / static_cast<float>(substeps);
        const auto cloth = between(event.clothBefore, event.clothNow, time);
        const auto needle = between(event.needleBefore, event.needleNow, time);
        const double begin = report::threadCpuUs();
        const TrackResult result = tracker.step({cloth, {}, stretch, {}}, {needle, {}, Stretch::rigid(), {}}, settings);
        us += report::threadCpuUs() - begin;
        work += static_cast<double>(result.work);
        if (!result.contacts.empty()) {
            found = static_cast<double>(time);
        }
    }
    answers.us.push_back(us);
    answers.work.push_back(work);
    return found;
}

std::string labelled(const char* what, float number) {
    std::ostringstream text;
    text << what << ' ' << number;
    return text.str();
}

ImpactAnswers named(std::string name, bool hasTime = true) {
    ImpactAnswers answers;
    answers.name = std::move(name);
    answers.hasTime = hasTime;
    return answers;
}

/// The waving cloth, and what is claimed of it.
void addNeedle(const Options& options, report::Report& results) {
    const int events = options.poses.value_or(options.quick ? 120 : 10'000);
    const TunnelScene scene(options.quick ? 40 : 100);
    const BallTree cloth = buildBallTree(scene.cloth.view());
    const BallTree needle = buildBallTree(scene.needle.view());
    const std::size_t triangles = scene.cloth.triangles.size() + scene.needle.triangles.size();
    ImpactQuery query(cloth, needle);
    Tracker tracker(cloth, needle);
    test::Random random(options.seed);
    std::size_t asked = 0;
    std::size_t hits = 0;
    std::size_t found = 0;
    std::size_t falseHits = 0;
    std::size_t timesOff = 0;
    std::size_t discreteMisses = 0;
    std::size_t budgetFalse = 0;
    const std::vector<float> speeds{0.005F, 0.02F, 0.05F, 0.1F, 0.3F, 1.0F};
    for (std::size_t s = 0; s < speeds.size(); ++s) {
        const float speed = speeds[s];
        std::cerr << "needle at " << speed << " ...\n";
        const double allowed = std::max(1e-3, 1e-5 / static_cast<double>(speed));
        ImpactAnswers exact = named("by time, bound given");
        ImpactAnswers measured = named("by time, bound measured");
        std::vector<std::pair<ImpactAnswers, std::uint64_t>> budgets;
        for (const std::uint64_t work : {32U, 64U, 128U, 256U}) {
            budgets.emplace_back(named(std::to_string(work) + " units"), work);
        }
        ImpactAnswers once = named("at the end only", false);
        ImpactAnswers often = named("16 substeps", false);
        RecallOverBudget shares;
        std::size_t colliding = 0;
        const auto share = static_cast<int>(s);
        const int count = (events + static_cast<int>(speeds.size()) - 1 - share) / static_cast<int>(speeds.size());
        for (int i = 0; i < count; ++i) {
            const TunnelEvent event = scene.event(speed, false, random);
            const double truth = test::meshImpact({scene.cloth.triangles, event.clothBefore, event.clothNow},
                                                  {scene.needle.triangles, event.needleBefore, event.needleNow});
            colliding += truth != test::noImpact ? 1 : 0;
            const Stretch given = Stretch::given(1.02F * std::max(measureStretch(cloth.surface, event.clothBefore),
                                                                  measureStretch(cloth.surface, event.clothNow)));
            const SurfaceMotion a{event.clothBefore, event.clothNow, {}, given, {}};
            const SurfaceMotion b{event.needleBefore, event.needleNow, {}, Stretch::given(1.001F), {}};
            ImpactSettings settings;
            settings.tolerance = tolerance;
            settings.seed = options.seed;
            settings.step = static_cast<std::uint64_t>(i);
            const std::uint64_t whole = askWith(exact, query, a, b, settings, unlimited, truth, allowed);
            shares.ask(query, a, b, settings, whole, truth, allowed);
            SurfaceMotion unknown = a;
            unknown.stretch = Stretch::measured();
            askWith(measured, query, unknown, b, settings, unlimited, truth, allowed);
            for (auto& [answers, work] : budgets) {
                askWith(answers, query, a, b, settings, work, truth, allowed);
            }
            once.judge(bySubsteps(once, tracker, event, given, 1), truth, allowed);
            often.judge(bySubsteps(often, tracker, event, given, 16), truth, allowed);
        }
        asked += static_cast<std::size_t>(count);
        hits += colliding;
        found += colliding - exact.misses;
        falseHits += exact.falseHits;
        timesOff += exact.late;
        discreteMisses += once.misses;
        const std::string name = labelled("speed", speed);
        const auto add = [&](const ImpactAnswers& answers) {
            results.rows.push_back(rowOf("needle", name, triangles, answers, often, colliding));
        };
        add(exact);
        add(measured);
        for (const auto& [answers, work] : budgets) {
            budgetFalse += answers.falseHits;
            add(answers);
        }
        for (const ImpactAnswers& answers : shares.answers()) {
            budgetFalse += answers.falseHits;
            add(answers);
        }
        add(once);
        add(often);
    }
    const auto claim = [&](std::string text, double value, bool atLeast, double bound) {
        results.claims.push_back({"needle: " + std::move(text), value, atLeast, bound});
    };
    claim("events that hit / all", static_cast<double>(hits) / static_cast<double>(asked), true, 0.3);
    claim("events that miss / all", 1 - static_cast<double>(hits) / static_cast<double>(asked), true, 0.1);
    claim("hits found / hits", static_cast<double>(found) / static_cast<double>(hits), true, 0.999);
    claim("false hits", static_cast<double>(falseHits), false, 0);
    claim("times farther off than max(1e-3 step, 1e-5 diagonal / speed)", static_cast<double>(timesOff), false, 0);
    claim("false hits under budgets", static_cast<double>(budgetFalse), false, 0);
    claim("hits that the end of the step alone misses / hits",
          static_cast<double>(discreteMisses) / static_cast<double>(hits), true, 0.2);
}

/// FCL knows rigid bodies only: a cloth that stays as it is, and bodies that turn.
void addRigid(const Options& options, report::Report& results) {
    const int events = options.quick ? 6 : 60;
    const TunnelScene scene(options.quick ? 40 : 100);
    const BallTree cloth = buildBallTree(scene.cloth.view());
    const FclModel fclCloth(scene.cloth.view());
    test::Random random(options.seed + 1);
    for (const float speed : {0.05F, 0.3F, 1.0F}) {
        std::cerr << "rigid needle at " << speed << " ...\n";
        const double allowed = std::max(1e-3, 1e-5 / static_cast<double>(speed));
        ImpactAnswers ours = named("by time");
        ImpactAnswers fcl = named("FCL conservative advancement");
        ImpactAnswers steps = named("FCL 1000 substeps");
        std::size_t colliding = 0;
        for (int i = 0; i < events; ++i) {
            const TunnelEvent event = scene.event(speed, true, random);
            const Pose still;
            const Eigen::Vector3f path = event.needleNow[0] - event.needleBefore[0];
            const scenes::Mesh placed{event.needleBefore, scene.needle.triangles};
            const BallTree placedTree = buildBallTree(placed.view());
            const FclModel fclPlaced(placed.view());
            const double truth = test::meshImpact({scene.cloth.triangles, scene.cloth.vertices, scene.cloth.vertices},
                                                  {placed.triangles, event.needleBefore, event.needleNow});
            colliding += truth != test::noImpact ? 1 : 0;
            ImpactSettings settings;
            settings.tolerance = tolerance;
            ImpactQuery own(cloth, placedTree);
            askWith(ours, own, rigidMotion(), rigidMotion({{}, path, {0, 0, 0}}), settings, unlimited, truth, allowed);
            const Pose to{Eigen::Matrix3f::Identity(), path};
            for (const auto& [answers, solver, error] :
                 {std::tuple{&fcl, FclSolver::advancement, 1e-4}, {&steps, FclSolver::substeps, 1e-3}}) {
                answers->judge(
                    timed(*answers, [&] { return fclCloth.impact(still, still, fclPlaced, still, to, error, solver); }),
                    truth, allowed);
            }
        }
        const std::string name = labelled("speed", speed);
        const std::size_t triangles = scene.cloth.triangles.size() + scene.needle.triangles.size();
        for (const ImpactAnswers* answers : {&ours, &fcl, &steps}) {
            results.rows.push_back(rowOf("rigid needle", name, triangles, *answers, steps, colliding));
        }
        results.claims.push_back({"rigid needle, " + name + ": hits missed, false hits and times off",
                                  static_cast<double>(ours.misses + ours.falseHits + ours.late), false, 0});
    }
}

/// Bodies that turn: is what is said to be free free, and is there contact where contact is said to be?
void addTurning(const Options& options, report::Report& results) {
    const int events = options.quick ? 6 : 60;
    const int frequency = options.quick ? 10 : 22;
    const scenes::Mesh meshA = scenes::normalised(scenes::bumpySphere(1.0F, 0.27F, 13, frequency, 5), 1);
    const scenes::Mesh meshB = scenes::normalised(scenes::bumpySphere(1.0F, 0.22F, 9, frequency, 6), 1);
    const BallTree treeA = buildBallTree(meshA.view());
    const BallTree treeB = buildBallTree(meshB.view());
    const Tree boxesA = build(meshA.view());
    const Tree boxesB = build(meshB.view());
    const FclModel fclA(meshA.view());
    const FclModel fclB(meshB.view());
    ImpactQuery query(treeA, treeB);
    Query discrete(boxesA, boxesB);
    test::Random random(options.seed + 2);
    DecideSettings exactly;
    exactly.estimateSteps = 0;
    for (const float turn : {0.1F, 1.0F, 3.0F}) {
        std::cerr << "turning by " << turn << " ...\n";
        ImpactAnswers ours = named("by time");
        ImpactAnswers fcl = named("FCL conservative advancement");
        ImpactAnswers steps = named("FCL 1000 substeps");
        std::size_t colliding = 0;
        std::size_t notFree = 0;
        std::size_t notThere = 0;
        std::size_t late = 0;
        for (int i = 0; i < events; ++i) {
            const Eigen::Vector3f side = random.direction();
            const RigidMotion a{{random.rotation(), {0, 0, 0}}, {0, 0, 0}, turn * random.direction()};
            const RigidMotion b{{random.rotation(), static_cast<float>(random.uniform(0.7, 1.1)) * side},
                                0.3F * random.direction() - 0.2F * side,
                                turn * random.direction()};
            ImpactSettings settings;
            settings.tolerance = 1e-5F;
            const ImpactResult result =
                timed(ours, [&] { return query.find(rigidMotion(a), rigidMotion(b), settings); });
            ours.note(result);
            const auto relative = [&](double time) { return compose(inverse(poseAt(a, time)), poseAt(b, time)); };
            constexpr int samples = 1000;
            const auto free = static_cast<double>(result.freeUntil);
            for (int k = 0; k < samples; ++k) {
                const double time = free * (static_cast<double>(k) + 0.5) / samples;
                notFree += free > 0 && discrete.decide(relative(time), exactly).collides ? 1 : 0;
            }
            double truth = test::noImpact;
            if (result.impact) {
                ++colliding;
                truth = static_cast<double>(result.impact->time);
                const Pose where = relative(truth);
                notThere += discrete.contacts(where, {.maxDistance = 1.5e-5F}).pairs.empty() ? 1 : 0;
                late += truth > 0 && discrete.decide(where, exactly).collides ? 1 : 0;
            }
            // By our answer: there is no other truth of bodies that turn.
            for (const auto& [answers, solver, error] :
                 {std::tuple{&fcl, FclSolver::advancement, 1e-4}, {&steps, FclSolver::substeps, 1e-3}}) {
                answers->judge(timed(*answers,
                                     [&] {
                                         return fclA.impact(poseAt(a, 0), poseAt(a, 1), fclB, poseAt(b, 0),
                                                            poseAt(b, 1), error, solver);
                                     }),
                               truth, 1.01e-3);
            }
        }
        const std::string name = labelled("turn", turn);
        const std::size_t triangles = meshA.triangles.size() + meshB.triangles.size();
        for (const ImpactAnswers* answers : {&ours, &fcl, &steps}) {
            results.rows.push_back(rowOf("turning", name, triangles, *answers, steps, colliding));
        }
        const auto claim = [&](const char* text, std::size_t value) {
            results.claims.push_back({"turning, " + name + ": " + text, static_cast<double>(value), false, 0});
        };
        claim("overlaps at one of 1000 moments said to be free", notFree);
        claim("impacts without contact there", notThere);
        claim("impacts after the start at which they overlap already", late);
        if (!options.quick) {
            results.claims.push_back({"turning, " + name + ": FCL 1000 substeps / ours",
                                      report::mean(steps.us) / report::mean(ours.us), true, 1});
        }
    }
}

/// Two bodies that deform while they approach, in steps of several frames of the suite `tracking`.
void addDeforming(const Options& options, report::Report& results) {
    const int frames = options.quick ? 10 : 40;
    const TrackingScene scene = twoBodies("2x10k", 22, 9);
    const BallTree treeA = buildBallTree(scene.a.view());
    const BallTree treeB = buildBallTree(scene.b.view());
    ImpactQuery query(treeA, treeB);
    ImpactAnswers exact = named("by time, bound measured");
    ImpactAnswers budget = named("256 units");
    RecallOverBudget shares;
    std::size_t colliding = 0;
    for (int frame = 0; frame + 1 < frames; ++frame) {
        const TrackingFrame before = twoBodiesAt(scene, 0.12F, frame, frames);
        const TrackingFrame now = twoBodiesAt(scene, 0.12F, frame + 1, frames);
        const double truth =
            test::meshImpact({scene.a.triangles, before.a, now.a}, {scene.b.triangles, before.b, now.b});
        colliding += truth != test::noImpact ? 1 : 0;
        ImpactSettings settings;
        settings.tolerance = tolerance;
        settings.step = static_cast<std::uint64_t>(frame);
        const SurfaceMotion a{before.a, now.a, {}, Stretch::measured(), {}};
        const SurfaceMotion b{before.b, now.b, {}, Stretch::measured(), {}};
        const std::uint64_t whole = askWith(exact, query, a, b, settings, unlimited, truth, 1e-3);
        shares.ask(query, a, b, settings, whole, truth, 1e-3);
        askWith(budget, query, a, b, settings, 256, truth, 1e-3);
    }
    const std::size_t triangles = scene.a.triangles.size() + scene.b.triangles.size();
    results.rows.push_back(rowOf("deforming", scene.name, triangles, exact, exact, colliding));
    results.rows.push_back(rowOf("deforming", scene.name, triangles, budget, exact, colliding));
    for (const ImpactAnswers& answers : shares.answers()) {
        results.rows.push_back(rowOf("deforming", scene.name, triangles, answers, exact, colliding));
    }
    results.claims.push_back(
        {"deforming: hits missed and false hits", static_cast<double>(exact.misses + exact.falseHits), false, 0});
    results.claims.push_back({"deforming: times off", static_cast<double>(exact.late), false, 0});
}

}  // namespace

report::Report runContinuousSuite(const Options& options) {
    report::Report results{
        .suite = "continuous", .seed = options.seed, .quick = options.quick, .rows = {}, .claims = {}};
    const auto wanted = [&](const char* scenario) {
        return options.scenarios.empty() || std::ranges::count(options.scenarios, scenario) > 0;
    };
    const std::pair<const char*, void (*)(const Options&, report::Report&)> scenarios[] = {
        {"needle", addNeedle}, {"rigid", addRigid}, {"turning", addTurning}, {"deforming", addDeforming}};
    for (const auto& [name, add] : scenarios) {
        if (wanted(name)) {
            add(options, results);
        }
    }
    return results;
}

}  // namespace grapeshot::bench
